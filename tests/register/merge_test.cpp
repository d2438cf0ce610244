#include "preprocess/merge.h"

#include <map>

#include "octree/error.h"
#include "octree/pack.h"
#include "preprocess/better_sample.h"
#include "preprocess/colour_balance.h"
#include "simulated_cave.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::SimulatedCave;

Poses poses_of(const std::vector<Scan>& scans, const std::vector<Eigen::Isometry3d>& T) {
    Poses poses;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        ScanPose pose;
        pose.file = pose_file(scans[i]);
        pose.T_world_scan = T[i];
        pose.status = PoseStatus::kRegistered;
        poses.scans.push_back(pose);
    }
    return poses;
}

TEST(Merge, BringsEveryPointToTheWorldWithItsStation) {
    const SimulatedCave cave = testing::two_chambers();
    std::vector<Eigen::Isometry3d> truth{testing::station_at({0, 0, 0}, 1),
                                         testing::station_at({1.5, 0.3, 0}, 2)};
    std::vector<Scan> scans;
    for (unsigned s = 0; s < 2; ++s)
        scans.push_back(testing::scan_cave(cave, truth[s], 8000, s + 1, 0.0));
    Poses poses = poses_of(scans, truth);
    poses.origin = {100, 200, 300};
    const PointCloud cloud = merge_scans(scans, poses, {.thin_overlaps = false});
    EXPECT_EQ(cloud.origin, (Vec3d{100, 200, 300}));
    ASSERT_EQ(cloud.stations.size(), 2u);
    EXPECT_NEAR(cloud.stations[1].position.x, 101.5, 1e-12);
    EXPECT_TRUE(cloud.stations[1].has_viewpoint);
    const double* q = cloud.stations[1].rotation;
    const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
    EXPECT_LE(rotation.angularDistance(Eigen::Quaterniond(truth[1].rotation())), 1e-9);
    double worst = 0.0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        const Vec3f p = cloud.points.positions[i];
        const Eigen::Vector3d place(p.x, p.y, p.z);
        const Eigen::Vector3d from = truth[cloud.points.stations[i]].translation();
        const double range = (place - from).norm();
        worst = std::max(worst, std::abs(cave.range(from, (place - from) / range) - range));
    }
    std::printf("worst distance from the walls %.2e m\n", worst);
    EXPECT_LE(worst, 1e-4);
}

TEST(Merge, LeavesOutWhatIsNotPlacedAndSaysSo) {
    const SimulatedCave cave = testing::two_chambers();
    const Eigen::Isometry3d T = testing::station_at({0, 0, 0}, 1);
    std::vector<Scan> scans{testing::scan_cave(cave, T, 5000, 1),
                            testing::scan_cave(cave, T, 5000, 2),
                            testing::scan_cave(cave, T, 5000, 3)};
    Poses poses = poses_of(scans, {T, T, T});
    poses.scans[1].status = PoseStatus::kUnregistered;
    poses.scans.pop_back();
    MergeReport report;
    const PointCloud cloud = merge_scans(scans, poses, {}, {}, &report);
    EXPECT_EQ(cloud.stations.size(), 1u);
    EXPECT_EQ(report.left_out, (std::vector<std::string>{"scan2", "scan3"}));
    EXPECT_THROW(merge_scans(scans, Poses{}, {}), Error);
    EXPECT_THROW(merge_scans({}, poses, {}), Error);
}

TEST(Merge, MovesTheOriginToScansThatLieFarAway) {
    const SimulatedCave cave = testing::two_chambers();
    const Eigen::Isometry3d T = testing::station_at({0, 0, 0}, 1);
    const Eigen::Isometry3d far(Eigen::Translation3d(400000.5, 5000000.25, 10.0) * T);
    const std::vector<Scan> scans{testing::scan_cave(cave, T, 5000, 1)};
    const PointCloud near_cloud = merge_scans(scans, poses_of(scans, {T}), {});
    const PointCloud far_cloud = merge_scans(scans, poses_of(scans, {far}), {.spacing = 0.05});
    EXPECT_GT(far_cloud.origin.y, 4.9e6);
    EXPECT_LT(length(far_cloud.points.positions[0]), 100.0f);
    EXPECT_NEAR(far_cloud.stations[0].position.x - near_cloud.stations[0].position.x, 400000.5,
                1e-6);
}

TEST(Merge, RemovesAPersonThatOnlyOneStationSaw) {
    const SimulatedCave empty = testing::two_chambers();
    SimulatedCave crowded = empty;
    for (int i = 0; i < 5; ++i)
        crowded.solid.push_back({{1.0, 1.2, -0.8 + 0.3 * i}, 0.25});
    std::vector<Eigen::Isometry3d> truth{testing::station_at({-0.5, -0.5, 0}, 1),
                                         testing::station_at({1.8, -0.6, 0}, 2),
                                         testing::station_at({0.2, 1.6, 0}, 3)};
    std::vector<Scan> scans;
    for (unsigned s = 0; s < 3; ++s) {
        scans.push_back(testing::scan_cave(s == 0 ? crowded : empty, truth[s], 30000, s + 1));
    }
    // Truth: what the first scan sees nearer than the empty cave.
    std::vector<std::uint8_t> person(scans[0].points.size());
    std::size_t people = 0;
    scans[0].points.intensities.resize(scans[0].points.size());
    for (std::size_t i = 0; i < person.size(); ++i) {
        const Vec3f p = scans[0].points.positions[i];
        const Eigen::Vector3d d = truth[0].rotation() * Eigen::Vector3d(p.x, p.y, p.z);
        person[i] = empty.range(truth[0].translation(), d.normalized()) > d.norm() + 0.05;
        scans[0].points.intensities[i] = person[i] ? 1.0f : 0.0f;
        people += person[i];
    }
    for (unsigned s = 1; s < 3; ++s)
        scans[s].points.intensities.assign(scans[s].points.size(), 0.0f);
    MergeReport report;
    const PointCloud cloud =
        merge_scans(scans, poses_of(scans, truth), {.thin_overlaps = false}, {}, &report);
    std::size_t left = 0;
    for (const float flag : cloud.points.intensities)
        left += flag > 0.5f ? 1 : 0;
    const std::size_t removed = people - left, lost = report.moving - removed;
    std::printf("person: removed %zu of %zu; walls lost %zu of %zu\n", removed, people, lost,
                report.points_in - people);
    ASSERT_GT(people, 200u);
    EXPECT_GE(removed, people * 9 / 10);
    EXPECT_LE(lost, report.points_in / 100);
    const PointCloud all = merge_scans(scans, poses_of(scans, truth),
                                       {.thin_overlaps = false, .remove_moving = false});
    EXPECT_EQ(all.points.size(), 90000u);
}

TEST(Merge, KeepsOneSampleAPlaceTheOneThatWasMeasuredBest) {
    // A wall at x = 2 seen head-on from 2 m and, slanted, from afar.
    Points wall;
    for (int y = 0; y < 40; ++y) {
        for (int z = 0; z < 40; ++z) {
            for (std::uint32_t station = 0; station < 2; ++station) {
                wall.positions.push_back(
                    {2.0f, 0.05f * static_cast<float>(y) + 0.01f * static_cast<float>(station),
                     0.05f * static_cast<float>(z)});
                wall.stations.push_back(station);
            }
        }
    }
    const std::vector<Vec3f> stations{{0, 1, 1}, {1, 12, 1}};
    const std::vector<std::uint8_t> viewpoints{1, 1};
    for (const std::uint32_t i : best_samples(wall, 0.1, stations, viewpoints)) {
        EXPECT_EQ(wall.stations[i], 0u);
    }
    // Nearer but at a glancing angle loses to farther and head-on.
    const std::vector<Vec3f> glancing{{1.95f, 1, 1}, {-1, 1, 1}};
    std::size_t head_on = 0;
    const std::vector<std::uint32_t> kept = best_samples(wall, 0.1, glancing, viewpoints);
    for (const std::uint32_t i : kept)
        head_on += wall.stations[i] == 1 ? 1 : 0;
    EXPECT_GT(head_on, kept.size() / 2);
    EXPECT_TRUE(best_samples(Points{}, 0.1, stations, viewpoints).empty());
    EXPECT_THROW(best_samples(wall, 1e-9, stations, viewpoints), Error);
}

TEST(ColourBalance, FindsTheGainsThatWereApplied) {
    const double gain[3] = {1.0, 0.8, 1.3};
    Points points;
    std::mt19937 rng(3);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (int i = 0; i < 30000; ++i) {
        const auto station = static_cast<std::uint32_t>(i % 3);
        const Vec3f p{4.0f * unit(rng), 4.0f * unit(rng), 0.0f};
        const double albedo = 0.3 + 0.15 * std::sin(3.0 * static_cast<double>(p.x));
        const auto code = static_cast<std::uint8_t>(
            std::lround(255.0f * linear_to_srgb(static_cast<float>(gain[station] * albedo))));
        points.positions.push_back(p);
        points.stations.push_back(station);
        points.colours.push_back({code, code, code});
    }
    const std::vector<Vec3d> gains = colour_gains(points, 3, 0.1);
    const double scale = gains[0].x * gain[0];
    for (std::size_t s = 0; s < 3; ++s) {
        std::printf("station %zu: gain %.4f, balanced %.4f of the first\n", s, gains[s].x,
                    gains[s].x * gain[s] / scale);
        EXPECT_NEAR(gains[s].x * gain[s] / scale, 1.0, 0.02);
    }
    apply_gains(points, gains);
    EXPECT_EQ(colour_gains(Points{}, 3, 0.1)[2], (Vec3d{1, 1, 1}));
}

TEST(Merge, GivesTheSameCloudTwice) {
    const SimulatedCave cave = testing::two_chambers();
    const std::vector<Eigen::Isometry3d> truth{testing::station_at({0, 0, 0}, 1),
                                               testing::station_at({1.5, 0.3, 0}, 2)};
    std::vector<Scan> scans;
    for (unsigned s = 0; s < 2; ++s)
        scans.push_back(testing::scan_cave(cave, truth[s], 8000, s + 1));
    const Poses poses = poses_of(scans, truth);
    const PointCloud a = merge_scans(scans, poses, {}), b = merge_scans(scans, poses, {});
    EXPECT_EQ(a.points.positions, b.points.positions);
    EXPECT_EQ(a.points.stations, b.points.stations);
}

}  // namespace
}  // namespace glowworm

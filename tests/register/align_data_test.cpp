// Real and simulated scans with known poses; the accuracy asked for is the one that is promised.
#include <tbb/global_control.h>

#include <random>
#include <sstream>

#include "preprocess/merge.h"
#include "preprocess/register/align.h"
#include "real_scans.h"
#include "simulated_cave.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::pose_error;
using testing::PoseError;

const std::vector<std::string> kCave{"scan00.ply", "scan01.ply", "scan02.ply",
                                     "scan03.ply", "scan04.ply", "scan05.ply",
                                     "scan06.ply", "scan07.ply", "scan08.ply"};

PoseError report(const Registration& result, const std::vector<Eigen::Isometry3d>& truth) {
    PoseError worst{0, 0};
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const ScanPose& pose = result.poses.scans[i];
        const PoseError e =
            pose_error(result.poses.scans[0].T_world_scan.inverse() * pose.T_world_scan,
                       truth[0].inverse() * truth[i]);
        std::printf("%-16s %-12s %8.4f deg %8.2f mm\n",
                    pose.file.substr(pose.file.rfind('/') + 1).c_str(),
                    to_string(pose.status).c_str(), e.degrees, e.millimetres);
        worst = {std::max(worst.degrees, e.degrees), std::max(worst.millimetres, e.millimetres)};
    }
    return worst;
}

Eigen::Isometry3d read_matrix(std::istream& in) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 16; ++i)
        in >> T.matrix()(i / 4, i % 4);
    return T;
}

TEST(RegistrationData, PlacesTheNineScansOfTheSimulatedCave) {
    GLOWWORM_DATA_OR_SKIP(data);
    const std::vector<Scan> scans = testing::load_clean(data / "scans/D_cavern", kCave);
    std::vector<Eigen::Isometry3d> truth;
    for (const ScanPose& pose : read_poses(data / "scans/D_cavern/poses.json").scans) {
        truth.push_back(pose.T_world_scan);
    }
    const Registration result = align_scans(scans, {});
    const PoseError worst = report(result, truth);
    EXPECT_TRUE(result.trustworthy());
    EXPECT_LE(worst.degrees, 0.05);
    EXPECT_LE(worst.millimetres, 5.0);

    // Merged: the people are gone, the walls are not.
    MergeReport merged;
    std::vector<Scan> raw;
    std::size_t people = 0;
    for (const std::string& name : kCave) {
        raw.push_back(testing::load(data / "scans/D_cavern" / name));
        raw.back().has_viewpoint = true;
        const std::string stem = name.substr(0, 6);
        // Colour tells the points of a person apart afterwards.
        for (Rgb8& c : raw.back().points.colours)
            c = {0, 0, 0};
        for (const std::uint32_t i :
             testing::load_indices(data / "scans/D_cavern" / (stem + "_obstacle.txt"))) {
            raw.back().points.colours[i] = {255, 0, 0};
            ++people;
        }
        for (const std::uint32_t i :
             testing::load_indices(data / "scans/D_cavern" / (stem + "_stray.txt"))) {
            raw.back().points.colours[i] = {0, 255, 0};
        }
    }
    const PointCloud cloud = merge_scans(raw, result.poses, {.thin_overlaps = false}, {}, &merged);
    std::size_t people_left = 0, walls_left = 0;
    for (const Rgb8& c : cloud.points.colours) {
        people_left += c == Rgb8{255, 0, 0} ? 1 : 0;
        walls_left += c == Rgb8{0, 0, 0} ? 1 : 0;
    }
    std::size_t walls = 0;
    for (const Scan& scan : raw) {
        for (const Rgb8& c : scan.points.colours)
            walls += c == Rgb8{0, 0, 0} ? 1 : 0;
    }
    const auto percent = [](std::size_t part, std::size_t whole) {
        return 100.0 * static_cast<double>(part) / static_cast<double>(whole);
    };
    std::printf("people removed %zu of %zu (%.1f %%), walls lost %zu of %zu (%.4f %%)\n",
                people - people_left, people, percent(people - people_left, people),
                walls - walls_left, walls, percent(walls - walls_left, walls));
    EXPECT_GE(people - people_left, people * 9 / 10);
    EXPECT_LE(walls - walls_left, walls / 100);
}

TEST(RegistrationData, AgreesWithinAMillimetreFromAnyStartOnAnyNumberOfThreads) {
    GLOWWORM_DATA_OR_SKIP(data);
    std::vector<Scan> scans =
        testing::load_clean(data / "scans/D_cavern", {"scan00.ply", "scan01.ply", "scan05.ply"});
    for (Scan& scan : scans)  // a fifth of the points keeps this quick
        scan.points = thin(scan.points, 0.05);
    std::mt19937 rng(11);
    std::normal_distribution<double> normal;
    std::vector<Eigen::Isometry3d> first;
    for (const std::size_t threads : {1, 2, 3}) {
        std::vector<Scan> started = scans;
        std::vector<Eigen::Isometry3d> starts, found;
        for (Scan& scan : started) {
            Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
            T.linear() = Eigen::Quaterniond(normal(rng), normal(rng), normal(rng), normal(rng))
                             .normalized()
                             .toRotationMatrix();
            for (Vec3f& p : scan.points.positions) {
                const Eigen::Vector3d q = T.linear() * Eigen::Vector3d(p.x, p.y, p.z);
                p = vec3_cast<float>(Vec3d{q.x(), q.y(), q.z()});
            }
            starts.push_back(T);
        }
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const Registration result = align_scans(started, {});
        EXPECT_EQ(result.unregistered, 0u);
        for (std::size_t i = 0; i < scans.size(); ++i)
            found.emplace_back(result.poses.scans[i].T_world_scan * starts[i]);
        if (first.empty()) first = found;
        for (std::size_t i = 1; i < scans.size(); ++i) {
            const PoseError e =
                pose_error(found[0].inverse() * found[i], first[0].inverse() * first[i]);
            std::printf("%zu threads, scan %zu: apart by %.5f deg, %.4f mm\n", threads, i,
                        e.degrees, e.millimetres);
            EXPECT_LE(e.millimetres, 1.0);
        }
    }
}

TEST(RegistrationData, PlacesTheRealTerrestrialScans) {
    GLOWWORM_DATA_OR_SKIP(data);
    const std::vector<Scan> scans = testing::load_clean(
        data / "obs_eq_tls", {"scan000.pcd", "scan001.pcd", "scan002.pcd", "scan003.pcd"});
    std::vector<Eigen::Isometry3d> truth;
    std::ifstream in(data / "obs_eq_tls/reference_poses.txt");
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string name;
        words >> name;
        if (name.starts_with("scan")) truth.push_back(read_matrix(words));
    }
    ASSERT_EQ(truth.size(), 4u);
    const Registration result = align_scans(scans, {});
    const PoseError worst = report(result, truth);
    EXPECT_TRUE(result.trustworthy());
    EXPECT_LE(worst.degrees, 0.3);
    EXPECT_LE(worst.millimetres, 30.0);
}

TEST(RegistrationData, PlacesTheRealPair) {
    GLOWWORM_DATA_OR_SKIP(data);
    const std::vector<Scan> scans =
        testing::load_clean(data / "small_gicp", {"target.ply", "source.ply"});
    std::ifstream in(data / "small_gicp/T_target_source.txt");
    const Registration result = align_scans(scans, {});
    const PoseError worst = report(result, {Eigen::Isometry3d::Identity(), read_matrix(in)});
    EXPECT_TRUE(result.trustworthy());
    EXPECT_LE(worst.degrees, 0.5);
    EXPECT_LE(worst.millimetres, 50.0);
}

TEST(RegistrationData, PlacesTheBunnyWhichHasNoViewpoint) {
    GLOWWORM_DATA_OR_SKIP(data);
    const std::vector<std::string> names{"bun000.ply", "bun045.ply", "bun090.ply", "bun315.ply"};
    const std::vector<Scan> scans = testing::load_clean(data / "stanford_bunny", names);
    std::vector<Eigen::Isometry3d> truth;
    for (const std::string& name : names) {
        std::ifstream in(data / "stanford_bunny/bun.conf");
        for (std::string line; std::getline(in, line);) {
            std::istringstream words(line);
            std::string kind, file;
            Eigen::Vector3d t;
            Eigen::Vector4d q;  // x y z w
            words >> kind >> file >> t.x() >> t.y() >> t.z() >> q[0] >> q[1] >> q[2] >> q[3];
            if (kind != "bmesh" || file != name) continue;
            // p_world = R(q)ᵀ p + t
            truth.push_back(Eigen::Translation3d(t) *
                            Eigen::Quaterniond(q).normalized().conjugate());
        }
    }
    ASSERT_EQ(truth.size(), names.size());
    const Registration result = align_scans(scans, {});
    const PoseError worst = report(result, truth);
    EXPECT_EQ(result.unregistered, 0u);
    EXPECT_LE(worst.degrees, 1.0);
    EXPECT_LE(worst.millimetres, 1.5);
}

TEST(RegistrationData, MixesNoSites) {
    GLOWWORM_DATA_OR_SKIP(data);
    std::vector<Scan> scans =
        testing::load_clean(data / "scans/D_cavern", {"scan00.ply", "scan01.ply"});
    scans.push_back(testing::load_clean(data / "obs_eq_tls", {"scan000.pcd"})[0]);
    for (Vec3f& p : scans[2].points.positions)
        p = p * 0.25f;  // of the cave's size
    const Registration result = align_scans(scans, {});
    EXPECT_EQ(result.unregistered, 1u);
    EXPECT_EQ(result.poses.scans[2].status, PoseStatus::kUnregistered);
}

TEST(RegistrationData, KeepsAMapOfOneMineAsItIs) {
    GLOWWORM_DATA_OR_SKIP(data);
    const std::vector<Scan> scans =
        testing::load_clean(data / "mine_pcr", {"2025-04-21-11-04-46.pcd"});
    EXPECT_FALSE(scans[0].has_viewpoint);
    const Registration result = align_scans(scans, {});
    EXPECT_EQ(result.poses.scans[0].status, PoseStatus::kReference);
    const PointCloud cloud = merge_scans(scans, result.poses, {});
    EXPECT_GT(cloud.points.size(), scans[0].points.size() / 3);
    EXPECT_FALSE(cloud.stations[0].has_viewpoint);
}

}  // namespace
}  // namespace glowworm

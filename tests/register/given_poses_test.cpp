#include <numbers>

#include "preprocess/register/align.h"
#include "two_chamber_site.h"

namespace glowworm {
namespace {

using namespace testing;

TEST(Registration, RefinesGivenPosesAndTrustsOrIgnoresThemOnRequest) {
    Site site = two_chamber_site();
    site.scans.resize(3);
    std::vector<Eigen::Isometry3d> given;
    for (std::size_t i = 0; i < 3; ++i) {
        // 10 cm and 1 degree off, far from the world's origin
        given.push_back(
            Eigen::Translation3d(400000.0, 5000000.0, 300.0) * site.truth[i] *
            Eigen::Translation3d(0.1 * static_cast<double>(i), 0, 0) *
            Eigen::AngleAxisd(0.017 * static_cast<double>(i), Eigen::Vector3d::UnitZ()));
        site.scans[i].T_world_scan = given[i];
    }
    const auto world_pose = [](const Registration& r, std::size_t i) {
        return Eigen::Isometry3d(
            Eigen::Translation3d(r.poses.origin.x, r.poses.origin.y, r.poses.origin.z) *
            r.poses.scans[i].T_world_scan);
    };
    const Registration refined = align_scans(site.scans, {});
    const PoseError worst = worst_error(refined, site.truth);
    std::printf("refined: %.4f deg, %.2f mm\n", worst.degrees, worst.millimetres);
    EXPECT_LE(worst.millimetres, 10.0);
    EXPECT_LE(pose_error(world_pose(refined, 0), given[0]).millimetres, 0.01)
        << "the reference holds the world of the given poses";
    EXPECT_GT(std::abs(refined.poses.origin.x), 1000.0) << "far coordinates need an origin";

    const Registration trusted = align_scans(site.scans, {.mode = PriorMode::kTrust});
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LE(pose_error(world_pose(trusted, i), given[i]).millimetres, 0.01);
        EXPECT_EQ(trusted.poses.scans[i].status, PoseStatus::kPrior);
    }
    const Registration ignored = align_scans(site.scans, {.mode = PriorMode::kIgnore});
    EXPECT_TRUE(ignored.poses.scans[0].T_world_scan.matrix().isIdentity(1e-12));
    EXPECT_LE(worst_error(ignored, site.truth).millimetres, 10.0);

    // A poses.json goes before what the scans carry.
    RegistrationSettings with_file{.mode = PriorMode::kTrust};
    with_file.prior = ignored.poses;
    const Registration from_file = align_scans(site.scans, with_file);
    EXPECT_TRUE(from_file.poses.scans[0].T_world_scan.matrix().isIdentity(1e-12));
}

TEST(Registration, GivesUpGivenPosesThatTheSurfacesContradict) {
    Site site = two_chamber_site();
    site.scans.resize(2);
    site.scans[0].T_world_scan = site.truth[0];
    site.scans[1].T_world_scan =
        site.truth[1] * Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
    const Registration result = align_scans(site.scans, {});
    EXPECT_EQ(unregistered(result), 0u);
    EXPECT_LE(worst_error(result, site.truth).millimetres, 10.0);
}

TEST(Registration, PlacesTheWorldByTheGivenPosesThatAgree) {
    // The first scan's pose is wrong, the others' are right.
    Site site = two_chamber_site();
    site.scans.resize(3);
    for (std::size_t i = 0; i < 3; ++i)
        site.scans[i].T_world_scan = site.truth[i];
    site.scans[0].T_world_scan = Eigen::Translation3d(0.9, -0.4, 0) * site.truth[0] *
                                 Eigen::AngleAxisd(std::numbers::pi / 3, Eigen::Vector3d::UnitZ());
    const Registration result = align_scans(site.scans, {});
    EXPECT_TRUE(result.trustworthy()) << distrust(result);
    for (std::size_t i = 0; i < 3; ++i) {
        const PoseError e = pose_error(result.poses.scans[i].T_world_scan, site.truth[i]);
        std::printf("scan %zu: %.4f deg, %.2f mm\n", i, e.degrees, e.millimetres);
        EXPECT_LE(e.millimetres, 5.0);
    }
}

TEST(Registration, TakesAwayAGivenPoseInTheFreeSpaceOfOthersThatNothingConfirms) {
    const Site site = two_chamber_site();
    std::vector<Scan> scans{site.scans[0], site.scans[1], site.scans[4]};
    scans[0].T_world_scan = site.truth[0];
    scans[1].T_world_scan = site.truth[1];
    scans[2].T_world_scan = site.truth[0];  // it stands in the other chamber
    const Registration result = align_scans(scans, {});
    EXPECT_EQ(unregistered(result), 1u);
    EXPECT_EQ(result.poses.scans[2].status, PoseStatus::kUnregistered);
    EXPECT_NE(distrust(result).find("1 of 3 scans could not be placed (scan5)"), std::string::npos)
        << distrust(result);
    // Asked to trust, it does.
    EXPECT_TRUE(align_scans(scans, {.mode = PriorMode::kTrust}).trustworthy());
}

TEST(Registration, TriesKnownPairsOnly) {
    Site site = two_chamber_site();
    site.scans.resize(3);
    const Registration result = align_scans(site.scans, {.pairs = {{0, 1}, {1, 2}}});
    EXPECT_EQ(result.pairs_tried, 2u);
    EXPECT_TRUE(result.trustworthy());
    EXPECT_LE(worst_error(result, site.truth).millimetres, 5.0);
    EXPECT_EQ(unregistered(align_scans(site.scans, {.pairs = {{0, 1}}})), 1u);
}

TEST(Registration, PlacesScansOfUnknownStationsAmongOthers) {
    // As a scan that was exported in some other frame: the scanner was not at its origin.
    Site site = two_chamber_site();
    site.scans.resize(3);
    const Eigen::Isometry3d moved(Eigen::Translation3d(30, -12, 4) *
                                  Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
    turn(site.scans[1], moved);
    site.scans[1].has_viewpoint = false;
    site.truth[1] = site.truth[1] * moved.inverse();
    const Registration result = align_scans(site.scans, {});
    EXPECT_TRUE(result.trustworthy()) << distrust(result);
    for (std::size_t i = 0; i < 3; ++i) {
        // At the station: far from it a small turn shifts the frame's origin a lot.
        const Eigen::Vector3d station =
            (i == 1 ? moved : Eigen::Isometry3d::Identity()).translation();
        const Eigen::Vector3d found = result.poses.scans[0].T_world_scan.inverse() *
                                      result.poses.scans[i].T_world_scan * station;
        const Eigen::Vector3d truth = site.truth[0].inverse() * site.truth[i] * station;
        std::printf("scan %zu: %.2f mm\n", i, 1000.0 * (found - truth).norm());
        EXPECT_LE((found - truth).norm(), 0.005);
    }
}

TEST(Registration, OfLevelledScannersTurnsAboutTheVerticalOnly) {
    const SimulatedCave cave = testing::two_chambers();
    Site site;
    for (unsigned s = 1; s <= 2; ++s) {
        site.truth.push_back(testing::station_at({1.5 * (s - 1), 0, 0}, s, 0.0));
        site.scans.push_back(testing::scan_cave(cave, site.truth.back(), kPoints, s));
    }
    const Registration result = align_scans(site.scans, {.upright = true});
    EXPECT_EQ(unregistered(result), 0u);
    EXPECT_LE(worst_error(result, site.truth).millimetres, 10.0);
    for (const ScanPose& pose : result.poses.scans) {
        EXPECT_NEAR(pose.T_world_scan.rotation()(2, 2), 1.0, 1e-9);
    }
}

}  // namespace
}  // namespace glowworm

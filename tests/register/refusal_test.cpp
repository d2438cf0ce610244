#include "octree/error.h"
#include "preprocess/register/align.h"
#include "preprocess/register/hold.h"
#include "two_chamber_site.h"

namespace glowworm {
namespace {

using namespace testing;

TEST(Registration, LeavesScansThatSeeNothingInCommonUnregistered) {
    const Site site = two_chamber_site();
    const Registration result = align_scans(std::vector<Scan>{site.scans[0], site.scans[4]}, {});
    EXPECT_EQ(unregistered(result), 1u);
    EXPECT_FALSE(result.trustworthy());
}

TEST(Registration, LeavesAScanOfAnotherSiteOut) {
    const Site site = two_chamber_site();
    SimulatedCave other;
    testing::add_chamber(other, {0, 0, 0}, 77);
    Scan foreign = testing::scan_cave(other, testing::station_at({0, 0, 0}, 9), kPoints, 9);
    const Registration result =
        align_scans(std::vector<Scan>{site.scans[0], site.scans[1], foreign}, {});
    EXPECT_EQ(unregistered(result), 1u);
    EXPECT_EQ(result.poses.scans[2].status, PoseStatus::kUnregistered);
}

TEST(Registration, RefusesAMirroredScan) {
    Site site = two_chamber_site();
    for (Vec3f& p : site.scans[1].points.positions)
        p.x = -p.x;
    const Registration result = align_scans(std::vector<Scan>{site.scans[0], site.scans[1]}, {});
    EXPECT_EQ(unregistered(result), 1u);
}

TEST(Registration, RefusesAPassageThatRepeatsItself) {
    // The same niches every 2.5 m: shifted by that the scans fit as well, and nothing tells.
    constexpr double kPeriod = 2.5;
    SimulatedCave cave;
    for (int i = -12; i <= 12; ++i) {
        for (int k = 0; k < 3; ++k) {
            cave.air.push_back(
                {{i * kPeriod + 0.3 * k, 0.25 * std::sin(2.1 * k), 0.2 * std::cos(1.7 * k)},
                 0.9 + 0.25 * k});
        }
        for (double x = 0; x < kPeriod; x += 0.4)
            cave.air.push_back({{i * kPeriod + x, 0, 0}, 0.8});
    }
    std::vector<Scan> scans;
    for (unsigned seed = 1; seed <= 2; ++seed) {
        const Eigen::Isometry3d T = testing::station_at({3.2 * seed, 0, 0}, seed);
        scans.push_back(testing::scan_cave(cave, T, 40000, seed));
        std::erase_if(scans.back().points.positions,
                      [](const Vec3f& p) { return length(p) > 9.0f; });
    }
    EXPECT_EQ(unregistered(align_scans(scans, {})), 1u);
}

TEST(Registration, SaysWhichWayAStraightTunnelLeavesOpen) {
    // A bare tube along X, 3 m wide, seen from two places 4 m apart.
    std::vector<Scan> scans;
    for (unsigned seed = 1; seed <= 2; ++seed) {
        std::mt19937 rng(seed);
        std::normal_distribution<double> noise(0.0, 0.003);
        Scan scan;
        scan.file = scan.name = "tube" + std::to_string(seed);
        scan.has_viewpoint = true;
        for (int i = 0; i < 40000; ++i) {
            Eigen::Vector3d d(noise(rng), noise(rng), noise(rng));
            d.normalize();
            const double range = 1.5 / std::hypot(d.y(), d.z()) + noise(rng);
            if (std::abs(range * d.x()) < 10.0) {
                scan.points.positions.push_back(
                    vec3_cast<float>(Vec3d{d.x(), d.y(), d.z()} * range));
            }
        }
        scans.push_back(scan);
    }
    const Registration result = align_scans(scans, {});
    EXPECT_FALSE(result.trustworthy());
    if (result.unregistered > 0) return;  // not placing them at all is honest as well
    bool along = false;
    for (const WeakAxis& axis : result.poses.scans[1].weak_axes) {
        std::printf("weak: %s (%.3f %.3f %.3f) information %.5f\n",
                    axis.rotation ? "turn" : "shift", axis.axis.x, axis.axis.y, axis.axis.z,
                    axis.information);
        along = along || (!axis.rotation && std::abs(axis.axis.x) > 0.95);
    }
    EXPECT_TRUE(along);
    EXPECT_EQ(result.loose, std::vector<std::size_t>{1});
    EXPECT_NE(distrust(result).find("nothing they see holds (tube2)"), std::string::npos)
        << distrust(result);
}

TEST(Registration, MakesEveryScanBehindAWeakLinkLoose) {
    // 0 and 1 hold each other, 2 and 3 do; between 1 and 2 lies a bare tunnel along X.
    const auto pair = [](std::size_t target, std::size_t source, bool tunnel) {
        PairFit fit;
        fit.target = target;
        fit.source = source;
        fit.accepted = true;
        fit.fit.extent = 2.0;
        fit.fit.information = 1000.0 * Matrix6d::Identity();
        fit.fit.information.topLeftCorner<3, 3>() *= 4.0;
        if (tunnel) fit.fit.information(3, 3) = 0.01;
        return fit;
    };
    const std::vector<Eigen::Isometry3d> poses(4, Eigen::Isometry3d::Identity());
    std::vector<PairFit> pairs{pair(0, 1, false), pair(2, 3, false), pair(1, 2, true)};
    const auto loose = loose_axes(pairs, poses, std::vector<std::uint8_t>{1, 0, 0, 0});
    EXPECT_TRUE(loose[0].empty());
    EXPECT_TRUE(loose[1].empty());
    for (const std::size_t i : {2, 3}) {
        ASSERT_EQ(loose[i].size(), 1u);
        EXPECT_NEAR(std::abs(loose[i][0].axis.x), 1.0, 1e-9);
        EXPECT_FALSE(loose[i][0].rotation);
    }
    EXPECT_EQ(scans_in_loops(pairs, 4), (std::vector<std::uint8_t>{0, 0, 0, 0}));
    // Another way round that holds along X makes all firm.
    pairs.push_back(pair(0, 3, false));
    for (const auto& axes : loose_axes(pairs, poses, std::vector<std::uint8_t>{1, 0, 0, 0}))
        EXPECT_TRUE(axes.empty());
    EXPECT_EQ(scans_in_loops(pairs, 4), (std::vector<std::uint8_t>{1, 1, 1, 1}));
}

TEST(Registration, RefusesNothingToRegisterAndCanBeCancelled) {
    EXPECT_THROW(align_scans({}, {}), Error);
    EXPECT_THROW(align_scans(std::vector<Scan>(2), {}), Error) << "scans without points";
    const Site site = two_chamber_site();
    EXPECT_THROW(align_scans(site.scans, {.max_scans = 2}), Error);
    EXPECT_THROW(align_scans(site.scans, {.voxel_size = -1.0}), Error);
    const Progress cancel = [](std::uint64_t, std::uint64_t) {
        throw Error(ExitCode::kCancelled, "cancelled");
    };
    EXPECT_THROW(align_scans(site.scans, {}, cancel), Error);
}

TEST(Registration, SurvivesPointsThatAreNoSurface) {
    Scan one;
    one.file = "one";
    one.points.positions = {{1, 2, 3}};
    Scan line;
    line.file = "line";
    for (int i = 0; i < 500; ++i)
        line.points.positions.push_back({0.01f * static_cast<float>(i), 0, 0});
    Scan equal;
    equal.file = "equal";
    equal.points.positions.assign(500, Vec3f{1, 1, 1});
    const Registration result = align_scans(std::vector<Scan>{one, line, equal}, {});
    EXPECT_EQ(unregistered(result), 2u);
}

}  // namespace
}  // namespace glowworm

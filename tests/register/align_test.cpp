#include "preprocess/register/align.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <numbers>
#include <span>

#include "octree/error.h"
#include "preprocess/register/hold.h"
#include "preprocess/register/pairwise.h"
#include "preprocess/register/plan_view.h"
#include "simulated_cave.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::pose_error;
using testing::PoseError;
using testing::SimulatedCave;

constexpr std::size_t kPoints = 25000;

struct Site {
    std::vector<Scan> scans;
    std::vector<Eigen::Isometry3d> truth;  // T_world_scan
};

/// Stations from one chamber through the passage into the other.
Site two_chamber_site() {
    const SimulatedCave cave = testing::two_chambers();
    Site site;
    unsigned seed = 1;
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2.2, 0.2, 0), Eigen::Vector3d(5.5, 0.8, 0.2),
          Eigen::Vector3d(9, 1.6, 0.4), Eigen::Vector3d(12.5, 2, 0.5)}) {
        site.truth.push_back(testing::station_at(place, seed));
        site.scans.push_back(testing::scan_cave(cave, site.truth.back(), kPoints, seed++));
    }
    return site;
}

/// Worst error of the placed scans, each relative to the first.
PoseError worst_error(const Registration& result, const std::vector<Eigen::Isometry3d>& truth) {
    PoseError worst{0, 0};
    const auto& scans = result.poses.scans;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        if (scans[i].status == PoseStatus::kUnregistered) continue;
        const PoseError e = pose_error(scans[0].T_world_scan.inverse() * scans[i].T_world_scan,
                                       truth[0].inverse() * truth[i]);
        worst = {std::max(worst.degrees, e.degrees), std::max(worst.millimetres, e.millimetres)};
    }
    return worst;
}

std::size_t unregistered(const Registration& result) {
    std::size_t count = 0;
    for (const ScanPose& pose : result.poses.scans) {
        count += pose.status == PoseStatus::kUnregistered ? 1 : 0;
    }
    EXPECT_EQ(count, result.unregistered);
    return count;
}

void turn(Scan& scan, const Eigen::Isometry3d& T) {
    for (Vec3f& p : scan.points.positions) {
        const Eigen::Vector3d q = T * Eigen::Vector3d(p.x, p.y, p.z);
        p = vec3_cast<float>(Vec3d{q.x(), q.y(), q.z()});
    }
}

TEST(Registration, PlacesEveryStationOfACaveWithoutPlanesFromNothing) {
    const Site site = two_chamber_site();
    const Registration result = align_scans(site.scans, {});
    const PoseError worst = worst_error(result, site.truth);
    std::printf("%s\nworst error %.4f deg, %.2f mm\n", trust_table(result).c_str(), worst.degrees,
                worst.millimetres);
    EXPECT_EQ(unregistered(result), 0u);
    EXPECT_TRUE(result.trustworthy());
    // The far stations hang on a chain of single links seen by scans of 25 k points.
    EXPECT_LE(worst.degrees, 0.05);
    EXPECT_LE(worst.millimetres, 5.0);
    EXPECT_EQ(result.poses.scans[0].status, PoseStatus::kReference);
    EXPECT_TRUE(result.poses.scans[0].T_world_scan.matrix().isIdentity(1e-12))
        << "the world is the reference scan's frame";
}

TEST(Registration, GivesTheSameBytesOnOneThreadAndOnFour) {
    Site site = two_chamber_site();
    site.scans.resize(3);
    std::vector<std::string> texts;
    for (const std::size_t threads : {1, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        texts.push_back(format_poses(align_scans(site.scans, {}).poses));
    }
    EXPECT_EQ(texts[0], texts[1]);
}

TEST(Registration, GivesTheSameBytesWhenItsPairsAreTriedElsewhere) {
    Site site = two_chamber_site();
    site.scans.resize(3);
    const PairPlan plan = plan_pairs(site.scans, {});
    ASSERT_GT(plan.pairs.size(), 2u);
    // Two jobs, each with the points of its own scans only; the last pair is left to the end.
    std::vector<PairFit> tried;
    for (std::size_t job = 0; job < 2; ++job) {
        const std::size_t count = plan.pairs.size() - 1, half = count / 2;
        const auto pairs =
            std::span(plan.pairs).subspan(job * half, job == 0 ? half : count - half);
        std::vector<Scan> own = site.scans;
        for (std::size_t i = 0; i < own.size(); ++i) {
            const bool named = std::ranges::any_of(
                pairs, [&](const auto& pair) { return pair.first == i || pair.second == i; });
            if (!named) own[i].points = {};
        }
        const std::vector<PairFit> fits = try_pairs(own, {}, plan, pairs);
        tried.insert(tried.begin(), fits.begin(), fits.end());
    }
    EXPECT_EQ(format_poses(align_scans(site.scans, {}, {}, tried).poses),
              format_poses(align_scans(site.scans, {}).poses));
}

TEST(Registration, DoesNotDependOnHowTheScansComeTurned) {
    Site site = two_chamber_site();
    site.scans.resize(3);
    const Registration plain = align_scans(site.scans, {});
    std::mt19937 rng(4);
    std::normal_distribution<double> normal;
    std::vector<Eigen::Isometry3d> turns;
    for (Scan& scan : site.scans) {
        turns.emplace_back(
            Eigen::Quaterniond(normal(rng), normal(rng), normal(rng), normal(rng)).normalized());
        turn(scan, turns.back());
    }
    const Registration turned = align_scans(site.scans, {});
    for (std::size_t i = 1; i < site.scans.size(); ++i) {
        const auto& a = plain.poses.scans;
        const auto& b = turned.poses.scans;
        const PoseError e =
            pose_error((b[0].T_world_scan * turns[0]).inverse() * (b[i].T_world_scan * turns[i]),
                       a[0].T_world_scan.inverse() * a[i].T_world_scan);
        std::printf("scan %zu: apart by %.5f deg, %.3f mm\n", i, e.degrees, e.millimetres);
        EXPECT_LE(e.millimetres, 1.0);
        EXPECT_LE(e.degrees, 0.01);
    }
}

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

TEST(Registration, PutsTheSameScanTwiceOnItself) {
    const Site site = two_chamber_site();
    std::vector<Scan> twice{site.scans[0], site.scans[0]};
    twice[1].file = "copy";
    const Registration result = align_scans(twice, {});
    EXPECT_EQ(unregistered(result), 0u);
    EXPECT_LE(worst_error(result, {site.truth[0], site.truth[0]}).millimetres, 0.01);
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

TEST(Registration, KeepsASingleScanAsItsOwnReference) {
    const Site site = two_chamber_site();
    Scan scan = site.scans[0];
    scan.offset = {2000, 3000, 0};
    const Registration result = align_scans(std::vector<Scan>{scan}, {});
    EXPECT_TRUE(result.trustworthy());
    EXPECT_EQ(result.poses.scans[0].status, PoseStatus::kReference);
    EXPECT_EQ(result.poses.origin, scan.offset);
    EXPECT_EQ(distrust(result), "");
    const std::string table = trust_table(result);
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 2) << "no pairs, no table of them";
    EXPECT_NE(table.find("-        -"), std::string::npos) << "nothing was measured:\n" << table;
    const Eigen::Vector3d first =
        result.poses.scans[0].T_world_scan * Eigen::Vector3d(2000, 3000, 0);
    EXPECT_LE(first.norm(), 1e-9);
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

TEST(PlanView, IsAPictureOfTheStationsAndTheirScans) {
    Site site = two_chamber_site();
    Registration result;
    for (std::size_t i = 0; i < site.scans.size(); ++i) {
        ScanPose pose;
        pose.file = pose_file(site.scans[i]);
        pose.T_world_scan = site.truth[i];
        pose.status = PoseStatus::kRegistered;
        result.poses.scans.push_back(pose);
    }
    const testing::ScratchFolder scratch;
    write_plan_view(site.scans, result.poses, scratch / "plan.png", 400);
    EXPECT_GT(std::filesystem::file_size(scratch / "plan.png"), 1000u);
}

}  // namespace
}  // namespace glowworm

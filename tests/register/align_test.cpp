#include "preprocess/register/align.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <span>

#include "preprocess/register/pairwise.h"
#include "simulated_chain.h"
#include "two_chamber_site.h"

namespace glowworm {
namespace {

using namespace testing;

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

TEST(Registration, PutsTheSameScanTwiceOnItself) {
    const Site site = two_chamber_site();
    std::vector<Scan> twice{site.scans[0], site.scans[0]};
    twice[1].file = "copy";
    const Registration result = align_scans(twice, {});
    EXPECT_EQ(unregistered(result), 0u);
    EXPECT_LE(worst_error(result, {site.truth[0], site.truth[0]}).millimetres, 0.01);
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

TEST(Registration, PlacesSparseScansOfANarrowPassage) {
    // 10 000 points each, 3 m apart, none of the links seen by more than two of them.
    const Chain chain = chain_of_stations({.stations = 4}, 1);
    const Registration result = align_scans(chain.scans, {});
    const PoseError worst = worst_error(result, chain.truth);
    std::printf("worst error %.4f deg, %.2f mm\n", worst.degrees, worst.millimetres);
    EXPECT_EQ(unregistered(result), 0u);
    EXPECT_LE(worst.degrees, 0.3);
    EXPECT_LE(worst.millimetres, 20.0);
}

}  // namespace
}  // namespace glowworm

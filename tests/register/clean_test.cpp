#include "preprocess/clean.h"

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "octree/error.h"
#include "preprocess/kd_tree.h"
#include "preprocess/station.h"
#include "real_scans.h"
#include "simulated_cave.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::SimulatedCave;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<Vec3f> random_points(std::size_t count, unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<Vec3f> points;
    for (std::size_t i = 0; i < count; ++i)
        points.push_back({unit(rng), unit(rng), 0.2f * unit(rng)});
    return points;
}

TEST(KdTree, FindsWhatBruteForceFinds) {
    std::vector<Vec3f> points = random_points(2000, 1);
    points[7] = points[1900];  // duplicates: the lower index first
    points[9] = {kNan, 0, 0};
    const KdTree tree(points);
    EXPECT_EQ(tree.size(), points.size() - 1);
    for (const Vec3f& query : random_points(200, 2)) {
        std::vector<std::pair<float, std::uint32_t>> expected;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            const Vec3f d = points[i] - query;
            if (is_finite(points[i])) expected.push_back({dot(d, d), i});
        }
        std::sort(expected.begin(), expected.end());
        std::vector<Neighbour> found(12);
        ASSERT_EQ(tree.nearest(query, found), 12u);
        for (std::size_t k = 0; k < found.size(); ++k)
            EXPECT_EQ(found[k].index, expected[k].second);
        EXPECT_EQ(tree.nearest(query).index, expected[0].second);
        EXPECT_FALSE(tree.nearest(query, 0.5f * std::sqrt(expected[0].first)).found());
    }
    EXPECT_EQ(tree.nearest(points[7]).index, 7u);
    EXPECT_FALSE(KdTree().nearest({0, 0, 0}).found());
    EXPECT_FALSE(tree.nearest({kNan, 0, 0}).found());
}

TEST(Thinning, KeepsOneRealPointOfEachCellNearestItsMean) {
    const std::vector<Vec3f> points = random_points(5000, 3);
    const double v = 0.1;
    const std::vector<std::uint32_t> kept = thin_indices(points, v);
    std::map<std::array<int, 3>, std::vector<std::uint32_t>> cells;
    const auto cell = [&](const Vec3f& p) {
        return std::array{static_cast<int>(std::floor(static_cast<double>(p.x) / v)),
                          static_cast<int>(std::floor(static_cast<double>(p.y) / v)),
                          static_cast<int>(std::floor(static_cast<double>(p.z) / v))};
    };
    for (std::uint32_t i = 0; i < points.size(); ++i)
        cells[cell(points[i])].push_back(i);
    ASSERT_EQ(kept.size(), cells.size());
    EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
    for (const std::uint32_t i : kept) {
        const std::vector<std::uint32_t>& members = cells[cell(points[i])];
        Vec3d mean;
        for (const std::uint32_t m : members)
            mean += vec3_cast<double>(points[m]);
        mean = mean / static_cast<double>(members.size());
        for (const std::uint32_t m : members) {
            EXPECT_LE(length(vec3_cast<double>(points[i]) - mean),
                      length(vec3_cast<double>(points[m]) - mean) + 1e-9);
        }
    }
}

TEST(Thinning, HoldsOnEmptySingleEqualAndBrokenPoints) {
    EXPECT_TRUE(thin_indices({}, 0.1).empty());
    EXPECT_EQ(thin_indices(std::vector<Vec3f>{{1, 2, 3}}, 0.1).size(), 1u);
    const std::vector<Vec3f> equal(10, Vec3f{1, 2, 3});
    EXPECT_EQ(thin_indices(equal, 0.1), std::vector<std::uint32_t>{0});
    const std::vector<Vec3f> broken{{kNan, 0, 0}, {0, 0, 0}, {0, INFINITY, 0}};
    EXPECT_EQ(thin_indices(broken, 0.1), std::vector<std::uint32_t>{1});
    EXPECT_THROW(thin_indices(equal, 0.0), Error);
    EXPECT_THROW(thin_indices(std::vector<Vec3f>{{0, 0, 0}, {1e6f, 0, 0}}, 1e-3), Error);
}

TEST(Thinning, KeepsEveryColumn) {
    Points points;
    points.positions = {{0, 0, 0}, {0.01f, 0, 0}, {1, 0, 0}};
    points.colours = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
    points.intensities = {1, 2, 3};
    const Points thinned = thin(points, 0.5);
    ASSERT_EQ(thinned.size(), 2u);
    EXPECT_EQ(thinned.colours[1], (Rgb8{3, 3, 3}));
    EXPECT_EQ(thinned.intensities[1], 3.0f);
}

TEST(Outliers, AreTheRaysThatEndInMidAir) {
    const SimulatedCave cave = testing::two_chambers();
    Scan scan = testing::scan_cave(cave, testing::station_at({0, 0, 0}, 1), 20000, 1);
    std::mt19937 rng(5);
    std::uniform_real_distribution<float> part(0.1f, 0.8f);
    std::set<std::uint32_t> strays;
    for (std::uint32_t i = 100; i < scan.points.size(); i += 400) {
        scan.points.positions[i] = scan.points.positions[i] * part(rng);
        strays.insert(i);
    }
    std::size_t removed = strays.size();
    const std::vector<std::uint32_t> kept = inlier_indices(scan.points.positions, true);
    for (const std::uint32_t i : kept)
        removed -= strays.count(i);
    const double lost = static_cast<double>(scan.points.size() - kept.size() - removed) /
                        static_cast<double>(scan.points.size());
    std::printf("strays removed %zu of %zu, surface lost %.3f %%\n", removed, strays.size(),
                100 * lost);
    EXPECT_GE(removed, strays.size() * 9 / 10);
    EXPECT_LE(lost, 0.01);
}

TEST(Outliers, AreNotSoughtAmongTooFewPointsAndBrokenOnesGo) {
    EXPECT_TRUE(inlier_indices({}, true).empty());
    const std::vector<Vec3f> few{{0, 0, 0}, {kNan, 0, 0}, {100, 0, 0}};
    EXPECT_EQ(inlier_indices(few, false), (std::vector<std::uint32_t>{0, 2}));
    const std::vector<Vec3f> equal(100, Vec3f{1, 2, 3});
    EXPECT_EQ(inlier_indices(equal, false).size(), 100u);
    EXPECT_THROW(inlier_indices(equal, false, {.neighbours = 1}), Error);
    EXPECT_THROW(inlier_indices(equal, false, {.factor = 0.5}), Error);
}

TEST(Cleaning, CountsWhatItRemoves) {
    Points points;
    points.positions = random_points(3000, 8);
    points.positions.push_back({50, 50, 50});
    points.positions.push_back({kNan, 0, 0});
    CleanReport report;
    const Points cleaned = clean(points, false, {.voxel_size = 0.05}, &report);
    EXPECT_EQ(report.points_in, points.size());
    EXPECT_GE(report.outliers, 2u);
    EXPECT_EQ(report.points_in - report.outliers - report.thinned, cleaned.size());
}

TEST(Cleaning, RemovesTheKnownStraysOfTheSimulatedCaveScans) {
    GLOWWORM_DATA_OR_SKIP(data);
    std::size_t strays = 0, removed = 0, surface = 0, lost = 0;
    for (const int i : {1, 4, 6}) {
        const std::string base = "scans/D_cavern/scan0" + std::to_string(i);
        const Scan scan = testing::load(data / (base + ".ply"));
        const std::set<std::uint32_t> known = testing::load_indices(data / (base + "_stray.txt"));
        std::vector<std::uint8_t> kept(scan.points.size());
        for (const std::uint32_t k : inlier_indices(scan.points.positions, true))
            kept[k] = 1;
        for (std::uint32_t k = 0; k < kept.size(); ++k) {
            (known.contains(k) ? strays : surface) += 1;
            (known.contains(k) ? removed : lost) += kept[k] ? 0 : 1;
        }
    }
    std::printf("strays removed %zu of %zu, surface lost %zu of %zu\n", removed, strays, lost,
                surface);
    EXPECT_GE(removed, strays * 9 / 10);
    EXPECT_LE(lost, surface / 100);
}

TEST(Viewpoint, IsToldFromTheDepthsInEachDirection) {
    const SimulatedCave cave = testing::two_chambers();
    const Scan one = testing::scan_cave(cave, testing::station_at({0, 0, 0}, 1), 30000, 1);
    EXPECT_TRUE(origin_is_viewpoint(one.points));

    // The same cave seen from four places, in the frame of the first: walls behind walls.
    Points merged = one.points;
    for (unsigned s = 2; s < 5; ++s) {
        const Eigen::Isometry3d T = testing::station_at({3.5 * s, 0.5 * s, 0.1 * s}, s);
        Points other = testing::scan_cave(cave, T, 30000, s).points;
        for (Vec3f& p : other.positions) {
            const Eigen::Vector3d w =
                testing::station_at({0, 0, 0}, 1).inverse() * T * Eigen::Vector3d(p.x, p.y, p.z);
            p = vec3_cast<float>(Vec3d{w.x(), w.y(), w.z()});
        }
        merged.append(other);
    }
    std::printf("hidden share: one station %.4f, merged %.4f\n",
                hidden_share(one.points, 0.6).share, hidden_share(merged, 0.6).share);
    EXPECT_FALSE(origin_is_viewpoint(merged));
    EXPECT_FALSE(origin_is_viewpoint(Points{}));
}

TEST(Viewpoint, IsRightAboutTheRealScans) {
    GLOWWORM_DATA_OR_SKIP(data);
    const std::pair<const char*, bool> expected[] = {
        {"scans/D_cavern/scan00.ply", true}, {"scans/D_cavern/scan06.ply", true},
        {"obs_eq_tls/scan000.pcd", true},    {"obs_eq_tls/scan003.pcd", true},
        {"small_gicp/source.ply", true},     {"stanford_bunny/bun045.ply", false},
        {"perf/lion_342k.ply", false},       {"mine_pcr/2025-04-21-11-04-46.pcd", false}};
    for (const auto& [file, viewpoint] : expected) {
        const Scan scan = testing::load(data / file);
        std::printf("%-36s hidden share %.4f (limit %.2f)\n", file,
                    hidden_share(scan.points, 0.15).share, kHiddenShareLimit);
        EXPECT_EQ(origin_is_viewpoint(scan.points), viewpoint) << file;
        if (!viewpoint) continue;
        // Written in the frame of a place beside the scanner, still within what it saw.
        Points aside = scan.points;
        for (Vec3f& p : aside.positions)
            p += Vec3f{1.5f, 1.0f, 0.0f};
        std::printf("%-36s hidden share %.4f\n", "  1.8 m aside", hidden_share(aside, 0.15).share);
        EXPECT_FALSE(origin_is_viewpoint(aside)) << file;
    }
}

}  // namespace
}  // namespace glowworm

#include "preprocess/surface/neighbours.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "preprocess/surface/flann_neighbours.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

using testing::Random;

float distance2(const PointTree& tree, std::size_t a, std::size_t b) {
    const Vec3f d = tree.position(b) - tree.position(a);
    return d.x * d.x + d.y * d.y + d.z * d.z;
}

/// Sorted by (distance, index): what the search promises, the slow way.
std::vector<std::uint32_t> brute_force(const PointTree& tree, int count, float radius) {
    std::vector<std::uint32_t> rows;
    for (std::size_t i = 0; i < tree.size(); ++i) {
        std::vector<std::pair<float, std::uint32_t>> all;
        for (std::uint32_t j = 0; j < tree.size(); ++j) {
            const float d2 = distance2(tree, i, j);
            if (j != i && d2 <= radius * radius) all.push_back({d2, j});
        }
        std::sort(all.begin(), all.end());
        all.resize(static_cast<std::size_t>(count),
                   {std::numeric_limits<float>::infinity(), kNoNeighbour});
        for (const auto& [d2, j] : all)
            rows.push_back(j);
    }
    return rows;
}

std::vector<Vec3f> mixed_cloud(int n) {
    Random random(3);
    std::vector<Vec3f> positions;
    for (int i = 0; i < n; ++i) {
        // Dense and sparse places, points on a lattice (ties) and far strays.
        const double scale = i % 3 == 0 ? 0.01 : i % 3 == 1 ? 1.0 : 30.0;
        Vec3d p{random.uniform(0, scale), random.uniform(0, scale), random.uniform(0, scale)};
        if (i % 5 == 0) p = {std::floor(p.x * 8) / 8, std::floor(p.y * 8) / 8, 0.5};
        positions.push_back(vec3_cast<float>(p));
    }
    return positions;
}

TEST(Neighbours, AreThoseOfBruteForceInTheSameOrder) {
    const PointTree tree = make_point_tree(mixed_cloud(1500));
    for (const int count : {1, 5, 15, 29, 63}) {
        for (const float radius : {0.05f, 2.0f, 1e6f}) {
            EXPECT_EQ(nearest_neighbours(tree, count, radius), brute_force(tree, count, radius))
                << count << " within " << radius;
        }
    }
}

TEST(Neighbours, AreThoseOfFlann) {
    const testing::Shape tube = testing::make_tube(40000, 1.0, 5.0);
    for (const PointTree& tree :
         {make_point_tree(tube.cloud.points.positions), make_point_tree(mixed_cloud(40000))}) {
        for (const int count : {15, 29}) {
            const auto ours = nearest_neighbours(tree, count, 3.0f);
            const auto flann = flann_neighbours(tree, count, 3.0f);
            ASSERT_EQ(ours.size(), flann.size());
            std::size_t ties = 0;
            for (std::size_t e = 0; e < ours.size(); ++e) {
                if (ours[e] == flann[e]) continue;
                ASSERT_NE(ours[e], kNoNeighbour);
                ASSERT_NE(flann[e], kNoNeighbour);
                const std::size_t i = e / static_cast<std::size_t>(count);
                ASSERT_EQ(distance2(tree, i, ours[e]), distance2(tree, i, flann[e]));
                ++ties;
            }
            std::printf("    k %d: %zu of %zu are ties taken in another order\n", count, ties,
                        ours.size());
        }
    }
}

TEST(PointTree, HoldsEveryPointOnceInBoxesThatNest) {
    const std::vector<Vec3f> positions = mixed_cloud(5000);
    const PointTree tree = make_point_tree(positions);
    EXPECT_EQ(tree.size() + tree.duplicates, positions.size());
    std::uint32_t next = 0;
    for (const std::uint32_t l : tree.leaves) {
        const PointTree::Node& leaf = tree.nodes[l];
        EXPECT_EQ(leaf.first, next);
        EXPECT_GT(leaf.count, 0u);
        EXPECT_LE(leaf.count, kLeafPoints);
        next += leaf.count;
        for (std::uint32_t i = leaf.first; i < next; ++i) {
            EXPECT_EQ(component_min(leaf.low, tree.position(i)), leaf.low);
            EXPECT_EQ(component_max(leaf.high, tree.position(i)), leaf.high);
            EXPECT_EQ(tree.position(i), positions[tree.order[i]]);
        }
    }
    EXPECT_EQ(next, tree.size());
    for (const PointTree::Node& node : tree.nodes) {
        for (std::uint32_t c = 0; c < node.children; ++c) {
            const PointTree::Node& child = tree.nodes[node.first_child + c];
            EXPECT_EQ(component_min(node.low, child.low), node.low);
            EXPECT_EQ(component_max(node.high, child.high), node.high);
        }
    }
}

TEST(PointTree, KeepsOneOfEqualPointsAndNoBrokenOnes) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    std::vector<Vec3f> positions(100, Vec3f{1, 2, 3});
    positions[10] = {kNaN, 0, 0};
    positions[20] = {2e7f, 0, 0};
    positions[30] = {4, 5, 6};
    const PointTree tree = make_point_tree(positions);
    EXPECT_EQ(tree.size(), 2u);
    EXPECT_EQ(tree.not_finite, 2u);
    EXPECT_EQ(tree.duplicates, 96u);
    EXPECT_THAT(tree.order, ::testing::UnorderedElementsAre(0u, 30u));
    EXPECT_EQ(make_point_tree({}).size(), 0u);
}

TEST(PointTree, PartsPointsThatShareTheFinestCell) {
    // A stray 10 000 km away leaves cells of metres: all others fall into a few of them.
    std::vector<Vec3f> positions = mixed_cloud(2000);
    positions.push_back({9e6f, 0, 0});
    const PointTree tree = make_point_tree(positions);
    for (const std::uint32_t l : tree.leaves)
        EXPECT_LE(tree.nodes[l].count, kLeafPoints);
    EXPECT_EQ(nearest_neighbours(tree, 7, 1.0f), brute_force(tree, 7, 1.0f));
}

}  // namespace
}  // namespace glowworm

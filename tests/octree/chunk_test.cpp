#include "octree/chunk.h"

#include <algorithm>
#include <random>
#include <set>

#include "clouds.h"
#include "octree/build.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::random_cloud;
using testing::sphere_cloud;
using testing::surfel_at;

TEST(Chunks, HoldEveryPointOnceInCellsOfTheGrid) {
    const SurfelCloud cloud = random_cloud(300000, 0.01f);
    const Octree octree = build_octree(cloud, {.depth = 6});
    ASSERT_GT(octree.chunks.size(), 4u);
    ASSERT_LT(octree.chunks.size(), 20u);
    ASSERT_EQ(octree.surfels.size(), cloud.surfels.size());
    for (const Chunk& chunk : octree.chunks) {
        EXPECT_LE(chunk.count, kMaxChunkSurfels);
        const float level = std::log2(octree.grid.cube_edge / chunk.box_edge);
        EXPECT_EQ(level, std::round(level));
        for (int axis = 0; axis < 3; ++axis) {
            const float cell = (chunk.box_min[axis] - octree.grid.cube_min[axis]) / chunk.box_edge;
            EXPECT_NEAR(cell, std::round(cell), 1e-3f);
        }
    }
}

TEST(Chunks, PositionsErrByLessThanASixteenthOfTheSpacing) {
    const SurfelCloud cloud = sphere_cloud(200000);
    const Octree octree = build_octree(cloud);
    std::vector<Vec3f> got;
    double spacing = 1e9;
    for (const Chunk& chunk : octree.chunks) {
        spacing = std::min(spacing, static_cast<double>(chunk.spacing));
        for (std::uint32_t i = chunk.first; i < chunk.first + chunk.count; ++i) {
            got.push_back(unpack_surfel(chunk, octree.surfels[i]).position);
        }
    }
    std::vector<Vec3f> truth;
    for (const Surfel& s : cloud.surfels)
        truth.push_back(s.position);
    // Spacing is 1.6 cm, far more than the error: sorting both by the nearest height pairs them.
    const auto by_z = [](const Vec3f& a, const Vec3f& b) { return a.z < b.z; };
    std::sort(got.begin(), got.end(), by_z);
    std::sort(truth.begin(), truth.end(), by_z);
    double worst_z = 0.0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        worst_z = std::max(worst_z, static_cast<double>(std::abs(got[i].z - truth[i].z)));
    }
    double worst_radius = 0.0;
    for (const Vec3f& p : got) {
        worst_radius = std::max(worst_radius, std::abs(length(vec3_cast<double>(p)) - 2.0));
    }
    EXPECT_LT(worst_z, spacing / 16.0);
    EXPECT_LT(worst_radius, spacing / 16.0);
}

TEST(Chunks, WhatASurfelHasComesBack) {
    SurfelCloud cloud = random_cloud(3, 0.05f);
    cloud.surfels[1].light = 1;
    const Octree octree = build_octree(cloud, {.depth = 2});
    ASSERT_EQ(octree.chunks.size(), 1u);
    for (const Surfel& truth : cloud.surfels) {
        const auto is_it = [&](const PackedSurfel& packed) {
            const Surfel got = unpack_surfel(octree.chunks[0], packed);
            return length(got.position - truth.position) < 1e-3f &&
                   dot(got.normal, truth.normal) > 0.99999f && got.station == truth.station &&
                   got.light == truth.light && std::abs(got.radius / truth.radius - 1) < 1e-3f &&
                   std::abs(got.ndf_length - truth.ndf_length) < 0.002f &&
                   length(got.albedo - truth.albedo) < 0.01f;
        };
        EXPECT_EQ(std::count_if(octree.surfels.begin(), octree.surfels.end(), is_it), 1);
    }
}

TEST(DetailOrder, IsAPermutationWithOnePointForEveryOccupiedCellOfALevel) {
    std::mt19937_64 random(9);
    std::vector<std::uint64_t> codes(5000);
    for (auto& code : codes)
        code = random() & 0xffffffffffff;
    codes[17] = codes[18] = codes[19];
    std::sort(codes.begin(), codes.end());
    const std::vector<std::uint32_t> order = detail_order(codes);
    ASSERT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), codes.size());
    for (int level = 0; level <= 5; ++level) {
        const auto cell = [&](std::uint64_t code) { return code >> (48 - 3 * level); };
        std::set<std::uint64_t> occupied, shown;
        for (const std::uint64_t code : codes)
            occupied.insert(cell(code));
        for (std::size_t i = 0; i < occupied.size(); ++i)
            shown.insert(cell(codes[order[i]]));
        EXPECT_EQ(shown.size(), occupied.size()) << "level " << level;
    }
}

/// rms distance from `points` to the nearest of `sample`.
double mean_gap(const std::vector<Vec3d>& points, const std::vector<Vec3d>& sample) {
    double sum = 0.0;
    for (const Vec3d& p : points) {
        double nearest = 1e30;
        for (const Vec3d& s : sample)
            nearest = std::min(nearest, dot(p - s, p - s));
        sum += nearest;
    }
    return std::sqrt(sum / static_cast<double>(points.size()));
}

TEST(DetailOrder, PrefixesCoverTheSurfaceMoreEvenlyThanARandomSubsetWould) {
    const SurfelCloud cloud = sphere_cloud(20000);
    const Octree octree = build_octree(cloud);
    ASSERT_EQ(octree.chunks.size(), 1u);
    std::vector<Vec3d> in_order;
    for (const PackedSurfel& s : octree.surfels) {
        in_order.push_back(vec3_cast<double>(unpack_surfel(octree.chunks[0], s).position));
    }
    std::vector<Vec3d> probes(in_order.begin() + 15000, in_order.end());
    for (const std::ptrdiff_t prefix : {250, 400, 700, 1000, 2500}) {
        const double ours = mean_gap(probes, {in_order.begin(), in_order.begin() + prefix});
        // In the plane a random set has 0.564 spacings, the best lattice 0.402.
        const double spacing = std::sqrt(16.0 * std::numbers::pi / static_cast<double>(prefix));
        EXPECT_LT(ours / spacing, 0.50) << prefix << " points";
    }
}

TEST(Chunks, OrderDoesNotDependOnTheOrderTheyCameIn) {
    SurfelCloud cloud = random_cloud(5000, 0.02f);
    for (std::size_t i = 0; i < 500; ++i) {
        cloud.surfels[i].position = cloud.surfels[i % 7].position;  // many in one place
    }
    const Octree a = build_octree(cloud, {.depth = 5});
    std::shuffle(cloud.surfels.begin(), cloud.surfels.end(), std::mt19937(1));
    const Octree b = build_octree(cloud, {.depth = 5});
    ASSERT_EQ(a.surfels.size(), b.surfels.size());
    for (std::size_t i = 0; i < a.surfels.size(); ++i) {
        ASSERT_EQ(a.surfels[i].position_xy, b.surfels[i].position_xy);
        ASSERT_EQ(a.surfels[i].normal, b.surfels[i].normal);
        ASSERT_EQ(a.surfels[i].albedo_ndf, b.surfels[i].albedo_ndf);
    }
}

TEST(Chunks, MoreThanAChunkOfPointsInOnePlaceIsCutByCount) {
    SurfelCloud cloud;
    cloud.stations.resize(1);
    cloud.surfels.assign(150000, surfel_at({1, 2, 3}, {0, 0, 1}, 0.01f));
    cloud.surfels.push_back(surfel_at({5, 2, 3}, {0, 0, 1}, 0.01f));
    const Octree octree = build_octree(cloud, {.depth = 4});
    ASSERT_EQ(octree.chunks.size(), 4u);
    EXPECT_EQ(octree.chunks[0].count, kMaxChunkSurfels);
    EXPECT_EQ(octree.chunks[3].count, 1u);
}

}  // namespace
}  // namespace glowworm

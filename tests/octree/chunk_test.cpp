#include "octree/chunk.h"

#include <algorithm>
#include <cstdio>
#include <numbers>
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

/// How far points err after packing, in local spacings: of each of `probes` surfels, from the
/// distance to its 16th neighbour. Surfels carry their index as station and light.
double worst_error(const SurfelCloud& cloud, const Octree& octree, std::size_t probes) {
    std::vector<Vec3d> packed(cloud.surfels.size());
    for (const Chunk& chunk : octree.chunks) {
        for (std::uint32_t i = chunk.first; i < chunk.first + chunk.count; ++i) {
            const Surfel s = unpack_surfel(chunk, octree.surfels[i]);
            packed[s.station | s.light << 16] = vec3_cast<double>(s.position);
        }
    }
    double worst = 0.0;
    std::vector<double> distances(cloud.surfels.size());
    for (std::size_t probe = 0; probe < probes; ++probe) {
        const std::size_t i = probe * 7919 % cloud.surfels.size();
        const Vec3d p = vec3_cast<double>(cloud.surfels[i].position);
        std::ranges::transform(cloud.surfels, distances.begin(), [&](const Surfel& s) {
            return length(vec3_cast<double>(s.position) - p);
        });
        std::ranges::nth_element(distances, distances.begin() + 16);
        const double spacing = distances[16] * std::sqrt(std::numbers::pi / 17.0);
        worst = std::max(worst, length(packed[i] - p) / spacing);
    }
    return worst;
}

/// A wall of 100 m, and on it `spots` spots of `points` points that lie `spacing` (m) apart.
SurfelCloud uneven_wall(std::size_t sparse, int spots, std::size_t points, float spacing) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    SurfelCloud cloud;
    cloud.stations.resize(1);
    const auto add = [&](float x, float z) {
        const auto index = static_cast<std::uint32_t>(cloud.surfels.size());
        cloud.surfels.push_back(surfel_at({x, 0.3f * x, z}, {0, 1, 0}, 0.1f));
        cloud.surfels.back().station = index & 0xffff;
        cloud.surfels.back().light = index >> 16;
    };
    for (std::size_t i = 0; i < sparse; ++i)
        add(50.0f * unit(random), 50.0f * unit(random));
    const float half = 0.5f * spacing * std::sqrt(static_cast<float>(points));
    for (int spot = 0; spot < spots; ++spot) {
        // Near the middle, where floats are fine enough to tell the points apart.
        const float x = 0.4f * unit(random), z = 0.4f * unit(random);
        for (std::size_t i = 0; i < points; ++i)
            add(x + half * unit(random), z + half * unit(random));
    }
    return cloud;
}

TEST(Chunks, PositionsErrByLessThanASixteenthOfTheSpacingWhereChunksAreUneven) {
    struct Case {
        std::size_t sparse;
        int spots;
        std::size_t points;
        float spacing;
    };
    for (const Case& c : {Case{20000, 1, 20000, 1e-4f}, Case{60000, 3, 1000, 1e-4f},
                          Case{5000, 200, 100, 3e-5f}, Case{1000, 1, 60, 1e-5f}}) {
        const SurfelCloud cloud = uneven_wall(c.sparse, c.spots, c.points, c.spacing);
        const Octree octree = build_octree(cloud, {.depth = 6});
        const double worst = worst_error(cloud, octree, 400);
        const std::size_t points = cloud.surfels.size();
        const auto bytes = static_cast<double>(octree.chunks.size() * sizeof(Chunk) +
                                               octree.surfels.size() * sizeof(PackedSurfel));
        std::printf(
            "%zu points: %zu chunks, %.2f bytes a point, worst error 1/%.1f of the spacing\n",
            points, octree.chunks.size(), bytes / static_cast<double>(points), 1.0 / worst);
        EXPECT_LT(worst, 1.0 / 16.0);
        EXPECT_LT(bytes, 20.5 * static_cast<double>(points));
    }
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

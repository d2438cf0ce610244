#include "octree/build.h"

#include <tbb/global_control.h>

#include <bit>
#include <cstring>
#include <limits>
#include <map>
#include <set>

#include "clouds.h"
#include "octree/error.h"
#include "octree/morton.h"
#include "octree/pack.h"
#include "octree/splat.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::random_cloud;
using testing::sphere_cloud;
using testing::surfel_at;

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_octree(const Octree& a, const Octree& b) {
    return same_bytes(a.levels, b.levels) && same_bytes(a.nodes, b.nodes) &&
           same_bytes(a.attributes, b.attributes) && same_bytes(a.lobes, b.lobes) &&
           same_bytes(a.chunks, b.chunks) && same_bytes(a.surfels, b.surfels);
}

using Cell = std::array<long, 3>;

Cell cell_of(const Vec3d& p, const Grid& grid, std::uint32_t level) {
    const double edge = std::ldexp(static_cast<double>(grid.cube_edge), -static_cast<int>(level));
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = std::floor((p[axis] - grid.cube_min[axis]) / edge);
        cell[static_cast<std::size_t>(axis)] =
            std::clamp(static_cast<long>(at), 0l, (1l << level) - 1);
    }
    return cell;
}

struct Totals {
    double area = 0.0;
    Vec3d ndf, albedo;
};

/// Area, NDF and albedo totals of every cell of a level, splatted into a map with nothing clever.
std::map<Cell, Totals> naive_totals(const SurfelCloud& cloud, const Grid& grid,
                                    std::uint32_t level) {
    std::map<Cell, Totals> cells;
    const LeafGrid leaves(grid);
    for (const Surfel& s : cloud.surfels) {
        const Splat splat = splat_of(s.radius / grid.voxel_size());
        const Disc disc(s, leaves);
        for (std::uint32_t piece = 0; piece < splat.pieces; ++piece) {
            const Vec3d p = vec3_cast<double>(grid.cube_min) +
                            disc.at(piece) * static_cast<double>(grid.voxel_size());
            Totals& cell = cells[cell_of(p, grid, level)];
            const double area = std::numbers::pi * s.radius * s.radius / splat.pieces;
            cell.area += area;
            cell.ndf += vec3_cast<double>(s.normal) * (area * s.ndf_length);
            cell.albedo += vec3_cast<double>(s.albedo) * area;
        }
    }
    return cells;
}

/// Walks the tree by its child pointers and hands every node's cell over.
template <typename Visit>
void walk(const Octree& octree, std::uint32_t node, std::uint32_t level, Cell cell,
          const Visit& visit) {
    visit(node, level, cell);
    if (level == octree.grid.depth) return;
    std::uint32_t child = octree.nodes[node].first;
    for (unsigned octant = 0; octant < 8; ++octant) {
        if (!(octree.nodes[node].mask >> octant & 1u)) continue;
        walk(octree, child++, level + 1,
             {cell[0] * 2 + (octant & 1), cell[1] * 2 + (octant >> 1 & 1),
              cell[2] * 2 + (octant >> 2)},
             visit);
    }
}

void expect_equals_naive_build(const SurfelCloud& cloud, const BuildSettings& settings) {
    const Octree octree = build_octree(cloud, settings);
    std::vector<std::map<Cell, Totals>> truth;
    for (std::uint32_t level = 0; level <= octree.grid.depth; ++level) {
        truth.push_back(naive_totals(cloud, octree.grid, level));
        ASSERT_EQ(octree.levels[level].node_count, truth.back().size()) << "level " << level;
    }
    double worst = 0.0;
    std::vector<std::size_t> visited(truth.size(), 0);
    walk(octree, 0, 0, {0, 0, 0}, [&](std::uint32_t node, std::uint32_t level, const Cell& cell) {
        ASSERT_TRUE(truth[level].contains(cell)) << "a node at level " << level << " nobody is in";
        const Totals& expected = truth[level][cell];
        const NodeAttributes& got = octree.attributes[node];
        worst = std::max(worst, std::abs(got.area - expected.area) / expected.area);
        for (int axis = 0; axis < 3; ++axis) {
            worst = std::max(worst, std::abs(got.ndf[axis] - expected.ndf[axis] / expected.area));
            worst =
                std::max(worst, std::abs(got.albedo[axis] - expected.albedo[axis] / expected.area));
        }
        EXPECT_GT(got.opacity, 0.0f);
        EXPECT_LE(got.opacity, 1.0f);
        ++visited[level];
    });
    for (std::size_t level = 0; level < truth.size(); ++level) {
        EXPECT_EQ(visited[level], truth[level].size());
    }
    EXPECT_LT(worst, 2e-6) << "worst relative difference from the naive build";
    ::testing::Test::RecordProperty("worst", std::to_string(worst));
}

TEST(Build, EqualsANaiveMapOnARandomCloud) {
    expect_equals_naive_build(random_cloud(3000, 0.02f), {.depth = 6});
}

TEST(Build, EqualsANaiveMapWhereDiscsSpanManyVoxels) {
    expect_equals_naive_build(random_cloud(300, 0.2f), {.depth = 6});
    expect_equals_naive_build(sphere_cloud(2000), {.depth = 7});
}

TEST(Build, EqualsANaiveMapOnARootAlone) {
    expect_equals_naive_build(random_cloud(100, 0.1f), {.depth = 0});
}

TEST(Build, EqualsANaiveMapWithPointsOnCellFacesAndAtBounds) {
    SurfelCloud cloud;
    cloud.stations.resize(1);
    for (float x = 0.0f; x <= 1.0f; x += 0.125f) {
        for (float y = 0.0f; y <= 1.0f; y += 0.125f) {
            cloud.surfels.push_back(surfel_at({x, y, 0.5f}, {0, 0, 1}, 0.01f));
        }
    }
    Grid grid;
    grid.cube_edge = 1.0f;
    grid.depth = 5;
    expect_equals_naive_build(cloud, {.grid = grid});
}

TEST(Build, EqualsANaiveMapWithAllPointsInOneVoxel) {
    SurfelCloud cloud = random_cloud(2000, 1e-5f);
    for (Surfel& s : cloud.surfels)
        s.position = s.position * 1e-4f;
    cloud.surfels.push_back(surfel_at({-2, -2, -2}, {0, 0, 1}, 1e-5f));
    cloud.surfels.push_back(surfel_at({2, 2, 2}, {0, 0, 1}, 1e-5f));
    expect_equals_naive_build(cloud, {.depth = 4});
}

TEST(Build, TotalsAreConservedAtEveryLevel) {
    const SurfelCloud cloud = random_cloud(5000, 0.03f);
    const Octree octree = build_octree(cloud, {.depth = 9});
    Totals truth;
    for (const Surfel& s : cloud.surfels) {
        const double area = std::numbers::pi * s.radius * s.radius;
        truth.area += area;
        truth.ndf += vec3_cast<double>(s.normal) * (area * s.ndf_length);
        truth.albedo += vec3_cast<double>(s.albedo) * area;
    }
    for (std::uint32_t level = 0; level <= 9; ++level) {
        Totals got;
        const Level at = octree.levels[level];
        for (std::uint32_t i = at.first_node; i < at.first_node + at.node_count; ++i) {
            const NodeAttributes& a = octree.attributes[i];
            got.area += a.area;
            got.ndf += Vec3d{a.ndf[0], a.ndf[1], a.ndf[2]} * static_cast<double>(a.area);
            got.albedo +=
                Vec3d{a.albedo[0], a.albedo[1], a.albedo[2]} * static_cast<double>(a.area);
        }
        EXPECT_NEAR(got.area / truth.area, 1.0, 1e-6) << "level " << level;
        EXPECT_LT(length(got.ndf - truth.ndf) / truth.area, 1e-6) << "level " << level;
        EXPECT_LT(length(got.albedo - truth.albedo) / length(truth.albedo), 1e-6) << level;
    }
}

TEST(Build, TheSameBytesOnAnyNumberOfThreads) {
    const SurfelCloud cloud = random_cloud(150000, 0.01f);
    const Octree many = build_octree(cloud, {.depth = 7});
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_TRUE(same_octree(many, build_octree(cloud, {.depth = 7})));
}

TEST(Build, ASinglePointBecomesOneLeafAndItsRoot) {
    SurfelCloud cloud;
    cloud.stations.resize(1);
    cloud.surfels.push_back(surfel_at({7, 8, 9}, {0, 1, 0}, 0.05f));
    const Octree octree = build_octree(cloud, {.depth = 1});
    ASSERT_EQ(octree.nodes.size(), 2u);
    ASSERT_EQ(octree.lobes.size(), 1u);
    EXPECT_NEAR(octree.lobes[0].position[0], 7.0f, 1e-6f);
    EXPECT_NEAR(octree.lobes[0].area, std::numbers::pi * 0.0025, 1e-8);
    EXPECT_EQ(octree.chunks.size(), 1u);
    EXPECT_EQ(build_octree(cloud).surfels.size(), 1u);
}

TEST(Build, WhatIsNotFiniteIsDroppedAndCounted) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    SurfelCloud cloud = random_cloud(1000, 0.02f);
    const Octree clean = build_octree(cloud, {.depth = 5});
    Surfel bad = cloud.surfels[1];
    bad.position.y = kNaN;
    cloud.surfels.insert(cloud.surfels.begin() + 10, bad);
    bad = cloud.surfels[1];
    bad.normal.x = kInfinity;
    cloud.surfels.insert(cloud.surfels.begin() + 500, bad);
    bad = cloud.surfels[1];
    bad.normal = {};
    cloud.surfels.push_back(bad);
    const Octree octree = build_octree(cloud, {.depth = 5});
    EXPECT_EQ(octree.dropped_count, 3u);
    EXPECT_EQ(octree.sample_count, 1000u);
    EXPECT_TRUE(same_octree(clean, octree));
}

TEST(Build, ACloudWithoutAUsablePointIsDegenerate) {
    SurfelCloud cloud;
    const auto code_of_failure = [&] {
        try {
            build_octree(cloud);
        } catch (const Error& error) {
            return error.code();
        }
        return ExitCode::kDone;
    };
    EXPECT_EQ(code_of_failure(), ExitCode::kDegenerate);
    cloud.surfels.push_back(
        surfel_at({std::numeric_limits<float>::quiet_NaN(), 0, 0}, {0, 0, 1}, 1));
    EXPECT_EQ(code_of_failure(), ExitCode::kDegenerate);
}

TEST(Build, AMissingRadiusComesFromTheSpacing) {
    SurfelCloud cloud = sphere_cloud(50000);
    const float truth = cloud.surfels[0].radius;
    for (Surfel& s : cloud.surfels)
        s.radius = 0.0f;
    const Octree octree = build_octree(cloud);
    EXPECT_NEAR(octree.chunks[0].max_radius / truth, 1.0f, 0.15f);
}

TEST(Build, AutomaticDepthGivesALeafFaceTheSamplesAskedFor) {
    const SurfelCloud cloud = sphere_cloud(100000);
    const Octree octree = build_octree(cloud);
    const double area = 4.0 * std::numbers::pi * 4.0 / 100000.0;
    const double per_face = octree.grid.voxel_size() * octree.grid.voxel_size() / area;
    EXPECT_GE(per_face, 3.5);
    EXPECT_LT(per_face, 4.0 * 3.5);
}

TEST(Build, VoxelSizeAndDepthAreKeptAndContradictionsRefused) {
    const SurfelCloud cloud = random_cloud(1000, 0.02f);
    EXPECT_FLOAT_EQ(build_octree(cloud, {.voxel_size = 0.1}).grid.voxel_size(), 0.1f);
    EXPECT_EQ(build_octree(cloud, {.depth = 4}).grid.depth, 4u);
    EXPECT_THROW(build_octree(cloud, {.depth = 22}), Error);
    EXPECT_THROW(build_octree(cloud, {.voxel_size = 1e-9}), Error);
    EXPECT_THROW(build_octree(cloud, {.voxel_size = -1.0}), Error);
    EXPECT_THROW(build_octree(cloud, {.depth = 2, .voxel_size = 0.1}), Error);
}

}  // namespace
}  // namespace glowworm

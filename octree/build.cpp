#include "octree/build.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "octree/chunk_packer.h"
#include "octree/error.h"
#include "octree/filter.h"
#include "octree/tables.h"
#include "octree/voxelize.h"

namespace glowworm {
namespace {

constexpr double kCubeMargin = 1.0 + 1.0 / 32.0;

/// Of a tile's own points; zero where it has none.
void find_bounds(std::span<const Surfel> surfels, std::span<const CodeIndex> own, Octree& octree) {
    octree.bounds_min = octree.bounds_max = {};
    if (own.empty()) return;
    octree.bounds_min = octree.bounds_max = surfels[own.front().index].position;
    for (const CodeIndex& entry : own) {
        const Vec3f& p = surfels[entry.index].position;
        octree.bounds_min = component_min(octree.bounds_min, p);
        octree.bounds_max = component_max(octree.bounds_max, p);
    }
}

void require_usable(const CloudSummary& summary) {
    const std::uint64_t total = summary.usable + summary.dropped;
    if (total > 0xffffffffu) {
        throw Error(ExitCode::kBudget,
                    "more than 4294967295 points do not fit one octree; build tiles");
    }
    if (summary.usable > 0) return;
    throw Error(ExitCode::kDegenerate, total == 0
                                           ? "the cloud has no points to build an octree from"
                                           : "none of the cloud's " + std::to_string(total) +
                                                 " points has a finite position and a normal");
}

std::uint32_t automatic_depth(const CloudSummary& summary, double cube_edge,
                              const BuildSettings& settings) {
    const double smallest = summary.median_spacing() * std::sqrt(settings.samples_per_face);
    std::uint32_t depth = 1;
    while (depth < settings.deepest_automatic && cube_edge / (2u << depth) >= smallest)
        ++depth;
    return depth;
}

}  // namespace

Grid fit_grid(const CloudSummary& summary, const Vec3d& origin, const BuildSettings& settings) {
    if (settings.grid) return *settings.grid;
    if (settings.depth && *settings.depth > kMaxDepth) {
        throw Error(ExitCode::kUsage, "a depth of " + std::to_string(*settings.depth) +
                                          " is too deep; the most is 21");
    }
    if (settings.voxel_size && !(*settings.voxel_size > 0.0 && *settings.voxel_size < 1e6)) {
        throw Error(ExitCode::kUsage, "the voxel size must be a positive number of metres");
    }
    const Vec3d lower = vec3_cast<double>(summary.bounds_min);
    const Vec3d upper = vec3_cast<double>(summary.bounds_max);
    const Vec3d extent = upper - lower;
    double edge = std::max({extent.x, extent.y, extent.z}) * kCubeMargin;
    if (edge <= 0.0) edge = summary.median_radius > 0.0 ? 64.0 * summary.median_radius : 1.0;

    std::uint32_t depth = 0;
    if (settings.voxel_size) {
        const double voxel = *settings.voxel_size;
        while (depth < kMaxDepth && std::ldexp(voxel, static_cast<int>(depth)) < edge)
            ++depth;
        if (settings.depth) depth = std::max(depth, *settings.depth);
        if (std::ldexp(voxel, static_cast<int>(depth)) < edge ||
            (settings.depth && *settings.depth != depth)) {
            throw Error(ExitCode::kUsage,
                        "voxels of " + std::to_string(voxel) + " m do not span the cloud's " +
                            std::to_string(edge) + " m in " +
                            std::to_string(settings.depth.value_or(kMaxDepth)) +
                            " levels; choose larger voxels or give the voxel size alone");
        }
        edge = std::ldexp(voxel, static_cast<int>(depth));
    }

    Grid grid;
    grid.origin = origin;
    grid.cube_edge = static_cast<float>(edge);
    grid.cube_min = vec3_cast<float>((lower + upper) * 0.5 - Vec3d{0.5, 0.5, 0.5} * edge);
    grid.depth = settings.voxel_size ? depth
                 : settings.depth    ? *settings.depth
                                     : automatic_depth(summary, edge, settings);
    return grid;
}

void require_tile(const BuildSettings& settings) {
    const OctreeCell& tile = *settings.tile;
    if (settings.grid && tile.level <= settings.grid->depth && tile.code >> (3 * tile.level) == 0)
        return;
    throw Error(ExitCode::kUsage, "a tile must be a cell of a given grid, not below its leaves");
}

void fill_missing_radii(SurfelCloud& cloud) {
    const CloudSummary summary = summarize(cloud.surfels);
    if (!summary.radius_missing || summary.usable == 0) return;
    double radius = summary.median_radius;
    if (radius == 0.0) {
        const Grid grid = fit_grid(summary, cloud.origin, {});
        radius = radius_from_spacing(cloud.surfels, grid, summary);
    }
    for (Surfel& surfel : cloud.surfels) {
        if (is_usable(surfel)) repair(surfel, radius);
    }
}

UnpackedOctree build_tree(SurfelCloud cloud, CloudSummary summary, const BuildSettings& settings,
                          const Progress& progress) {
    const std::uint64_t total = cloud.surfels.size();
    const auto report = [&](std::uint64_t fifths) {
        if (progress) progress(total * fifths / 5, total);
    };
    report(0);
    require_usable(summary);
    if (settings.tile) require_tile(settings);
    const OctreeCell tile = settings.tile.value_or(OctreeCell{});
    if (settings.tile && summary.radius_missing) {
        throw Error(ExitCode::kUsage,
                    "some points have no radius, and a tile cannot know the whole cloud's spacing; "
                    "run `glowworm surface` on the cloud first");
    }

    // 1. Grid and order. Without any radius the spacing comes from the order, then the depth.
    UnpackedOctree built;
    Octree& octree = built.octree;
    octree.grid = fit_grid(summary, cloud.origin, settings);
    built.sorted = sort_surfels(std::move(cloud.surfels), octree.grid, summary);
    octree.grid.depth = fit_grid(summary, cloud.origin, settings).depth;
    report(1);

    // 2. Leaves, and the levels over them.
    const auto& [surfels, codes] = built.sorted;
    SharedProgress splatting(progress, 2 * surfels.size(), 0.2, 0.6, total);
    Leaves leaves = voxelize(surfels, codes, octree.grid, tile, splatting);
    if (leaves.codes.empty()) {
        throw Error(ExitCode::kDegenerate, "the tile has no points and no surface");
    }
    report(3);
    const Progress filtering = [&](std::uint64_t levels, std::uint64_t all) {
        if (progress) progress((total * 3 * all + total * levels) / (5 * all), total);
    };
    NodeTree tree =
        build_nodes(octree.grid, leaves.codes, leaves.lobe_counts, leaves.lobes, filtering);
    octree.levels = std::move(tree.levels);
    octree.nodes = std::move(tree.nodes);
    octree.attributes = std::move(tree.attributes);
    octree.lobes = std::move(leaves.lobes);
    report(4);

    // 3. What is known of the points before they are packed.
    built.own = entries_in(codes, tile);
    octree.sample_count = built.own.size();
    octree.dropped_count = summary.dropped;
    octree.bounds_min = summary.bounds_min;
    octree.bounds_max = summary.bounds_max;
    if (tile.level > 0) find_bounds(surfels, built.own, octree);
    octree.provenance = settings.provenance;
    write_tables(cloud.stations, cloud.area_lights, octree);
    return built;
}

Octree build_octree(SurfelCloud cloud, const BuildSettings& settings, const Progress& progress) {
    const std::uint64_t total = cloud.surfels.size();
    const CloudSummary summary = summarize(cloud.surfels);
    UnpackedOctree built = build_tree(std::move(cloud), summary, settings, progress);
    Octree& octree = built.octree;
    octree.surfels.reserve(built.own.size());
    const ChunkPacker packer(built.sorted.surfels, built.own, octree.grid);
    SharedProgress packing(progress, built.own.size(), 0.8, 1.0, total);
    packer.pack(packing, [&](const Chunk& chunk, std::span<const PackedSurfel> surfels) {
        octree.chunks.push_back(chunk);
        octree.surfels.insert(octree.surfels.end(), surfels.begin(), surfels.end());
    });
    if (progress) progress(total, total);
    return std::move(octree);
}

}  // namespace glowworm

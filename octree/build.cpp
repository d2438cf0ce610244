#include "octree/build.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "octree/chunk.h"
#include "octree/error.h"
#include "octree/filter.h"
#include "octree/tables.h"
#include "octree/voxelize.h"

namespace glowworm {
namespace {

constexpr std::size_t kGrain = 16384;
constexpr double kCubeMargin = 1.0 + 1.0 / 32.0;

/// Codes of all usable surfels, sorted.
std::vector<CodeIndex> sorted_codes(std::span<const Surfel> surfels, const CloudSummary& summary,
                                    const Grid& grid) {
    std::vector<CodeIndex> order(surfels.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, surfels.size(), kGrain),
                      [&](const auto& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              order[i] = {grid.code_of(vec3_cast<double>(surfels[i].position)),
                                          static_cast<std::uint32_t>(i), 0};
                          }
                      });
    if (summary.dropped > 0) {
        std::erase_if(order, [&](const CodeIndex& e) { return !is_usable(surfels[e.index]); });
    }
    radix_sort(order);
    return order;
}

/// The surfels in the order of their codes, which then count them from the first on.
std::vector<Surfel> in_order(std::span<const Surfel> surfels, std::vector<CodeIndex>& order) {
    std::vector<Surfel> sorted(order.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order.size(), kGrain),
                      [&](const auto& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              if (i + kPrefetchAhead < order.size())
                                  prefetch(&surfels[order[i + kPrefetchAhead].index]);
                              sorted[i] = surfels[order[i].index];
                              order[i].index = static_cast<std::uint32_t>(i);
                          }
                      });
    return sorted;
}

/// Radius of a sample's share of the surface where none is given: at the deepest level with four
/// samples a cell, a surface of area A crosses about 1.5 A / h² cells.
double radius_from_spacing(std::span<const CodeIndex> order, const Grid& grid) {
    for (std::uint32_t level = kMortonLevels; level > 0; --level) {
        std::size_t cells = 1;
        for (std::size_t i = 1; i < order.size(); ++i) {
            cells += code_at_level(order[i].code, level) != code_at_level(order[i - 1].code, level);
        }
        if (order.size() < 4 * cells && level > 1) continue;
        const double edge = grid.cell_edge(level);
        const double area = static_cast<double>(cells) * edge * edge / 1.5;
        return std::sqrt(area / static_cast<double>(order.size()) / std::numbers::pi);
    }
    return grid.cube_edge;
}

void pack_surfels(std::span<const Surfel> surfels, std::span<const CodeIndex> order,
                  SharedProgress& progress, Octree& octree) {
    const std::vector<SurfelRange> ranges = split_into_chunks(order);
    octree.chunks.resize(ranges.size());
    octree.surfels.resize(order.size());
    tbb::parallel_for(std::size_t{0}, ranges.size(), [&](std::size_t i) {
        const SurfelRange& range = ranges[i];
        octree.chunks[i] =
            pack_chunk(surfels, order.subspan(range.begin, range.size()), octree.grid,
                       std::span(octree.surfels).subspan(range.begin, range.size()));
        octree.chunks[i].first = static_cast<std::uint32_t>(range.begin);
        progress.add(range.size());
    });
}

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
        radius = radius_from_spacing(sorted_codes(cloud.surfels, summary, grid), grid);
    }
    for (Surfel& surfel : cloud.surfels) {
        if (is_usable(surfel)) repair(surfel, radius);
    }
}

Octree build_octree(SurfelCloud cloud, const BuildSettings& settings, const Progress& progress) {
    const std::uint64_t total = cloud.surfels.size();
    const auto report = [&](std::uint64_t fifths) {
        if (progress) progress(total * fifths / 5, total);
    };
    report(0);

    CloudSummary summary = summarize(cloud.surfels);
    if (summary.usable == 0) {
        throw Error(ExitCode::kDegenerate, total == 0
                                               ? "the cloud has no points to build an octree from"
                                               : "none of the cloud's " + std::to_string(total) +
                                                     " points has a finite position and a normal");
    }
    if (total > 0xffffffffu) {
        throw Error(ExitCode::kBudget,
                    "more than 4294967295 points do not fit one octree; build tiles");
    }
    if (settings.tile) require_tile(settings);
    const OctreeCell tile = settings.tile.value_or(OctreeCell{});
    if (settings.tile && summary.radius_missing) {
        throw Error(ExitCode::kUsage,
                    "some points have no radius, and a tile cannot know the whole cloud's spacing; "
                    "run `glowworm surface` on the cloud first");
    }

    // 1. Grid and order. Without any radius the spacing has to come from the order first.
    Octree octree;
    octree.grid = fit_grid(summary, cloud.origin, settings);
    std::vector<CodeIndex> order = sorted_codes(cloud.surfels, summary, octree.grid);
    std::vector<Surfel> surfels = in_order(cloud.surfels, order);
    std::vector<Surfel>().swap(cloud.surfels);
    if (summary.needs_repair) {
        if (summary.median_radius == 0.0) {
            summary.median_radius = radius_from_spacing(order, octree.grid);
            octree.grid.depth = fit_grid(summary, cloud.origin, settings).depth;
        }
        for (Surfel& s : surfels)
            repair(s, summary.median_radius);
    }
    report(1);

    // 2. Leaves, and the levels over them.
    SharedProgress splatting(progress, 2 * surfels.size(), 0.2, 0.6, total);
    Leaves leaves = voxelize(surfels, order, octree.grid, tile, splatting);
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

    // 3. Points.
    const std::span<const CodeIndex> own = entries_in(order, tile);
    SharedProgress packing(progress, own.size(), 0.8, 1.0, total);
    pack_surfels(surfels, own, packing, octree);
    octree.sample_count = own.size();
    octree.dropped_count = summary.dropped;
    octree.bounds_min = summary.bounds_min;
    octree.bounds_max = summary.bounds_max;
    if (tile.level > 0) find_bounds(surfels, own, octree);
    octree.provenance = settings.provenance;
    write_tables(cloud.stations, cloud.area_lights, octree);
    report(5);
    return octree;
}

}  // namespace glowworm

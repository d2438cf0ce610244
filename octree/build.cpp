#include "octree/build.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
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

bool usable(const Surfel& s) {
    const float length_squared = dot(s.normal, s.normal);
    return is_finite(s.position) && std::isfinite(length_squared) && length_squared > 1e-12f &&
           is_finite(s.albedo) && is_finite(s.emission) && std::isfinite(s.ndf_length) &&
           !std::isnan(s.radius);
}

bool in_range(const Surfel& s) {
    const auto unit_interval = [](float v) { return v >= 0.0f && v <= 1.0f; };
    return std::abs(dot(s.normal, s.normal) - 1.0f) < 1e-3f && s.radius > 0.0f &&
           std::isfinite(s.radius) && s.ndf_length > 0.0f && s.ndf_length <= 1.0f &&
           unit_interval(s.albedo.x) && unit_interval(s.albedo.y) && unit_interval(s.albedo.z) &&
           s.emission.x >= 0.0f && s.emission.y >= 0.0f && s.emission.z >= 0.0f;
}

void repair(Surfel& s, float default_radius) {
    const auto unit_interval = [](float v) { return std::clamp(v, 0.0f, 1.0f); };
    s.normal = normalized(s.normal);
    if (!(s.radius > 0.0f) || !std::isfinite(s.radius)) s.radius = default_radius;
    s.ndf_length = std::clamp(s.ndf_length, 1.0f / 255.0f, 1.0f);
    s.albedo = {unit_interval(s.albedo.x), unit_interval(s.albedo.y), unit_interval(s.albedo.z)};
    s.emission = component_max(s.emission, Vec3f{});
}

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
        std::erase_if(order, [&](const CodeIndex& e) { return !usable(surfels[e.index]); });
    }
    radix_sort(order);
    return order;
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
                  Octree& octree) {
    const std::vector<SurfelRange> ranges = split_into_chunks(order);
    octree.chunks.resize(ranges.size());
    octree.surfels.resize(order.size());
    tbb::parallel_for(std::size_t{0}, ranges.size(), [&](std::size_t i) {
        const SurfelRange& range = ranges[i];
        octree.chunks[i] =
            pack_chunk(surfels, order.subspan(range.begin, range.size()), octree.grid,
                       std::span(octree.surfels).subspan(range.begin, range.size()));
        octree.chunks[i].first = static_cast<std::uint32_t>(range.begin);
    });
}

std::uint32_t automatic_depth(const CloudSummary& summary, double cube_edge,
                              const BuildSettings& settings) {
    const double spacing = std::sqrt(std::numbers::pi) * summary.median_radius;
    const double smallest = spacing * std::sqrt(settings.samples_per_face);
    std::uint32_t depth = 1;
    while (depth < settings.deepest_automatic && cube_edge / (2u << depth) >= smallest)
        ++depth;
    return depth;
}

}  // namespace

CloudSummary summarize(std::span<const Surfel> surfels) {
    constexpr float kFar = std::numeric_limits<float>::max();
    CloudSummary start;
    start.bounds_min = {kFar, kFar, kFar};
    start.bounds_max = {-kFar, -kFar, -kFar};
    CloudSummary summary = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, surfels.size(), kGrain), start,
        [&](const auto& range, CloudSummary sum) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                if (!usable(surfels[i])) {
                    ++sum.dropped;
                    continue;
                }
                ++sum.usable;
                sum.bounds_min = component_min(sum.bounds_min, surfels[i].position);
                sum.bounds_max = component_max(sum.bounds_max, surfels[i].position);
                sum.needs_repair |= !in_range(surfels[i]);
            }
            return sum;
        },
        [](CloudSummary a, const CloudSummary& b) {
            a.usable += b.usable;
            a.dropped += b.dropped;
            a.needs_repair |= b.needs_repair;
            a.bounds_min = component_min(a.bounds_min, b.bounds_min);
            a.bounds_max = component_max(a.bounds_max, b.bounds_max);
            return a;
        });

    constexpr std::size_t kRadiusSamples = 65536;
    std::vector<float> radii;
    const std::size_t stride = surfels.size() / kRadiusSamples + 1;
    for (std::size_t i = 0; i < surfels.size(); i += stride) {
        const float radius = surfels[i].radius;
        if (usable(surfels[i]) && radius > 0.0f && std::isfinite(radius)) radii.push_back(radius);
    }
    if (!radii.empty()) {
        const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
        std::nth_element(radii.begin(), middle, radii.end());
        summary.median_radius = *middle;
    }
    return summary;
}

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
    if (edge <= 0.0) edge = summary.median_radius > 0.0 ? 8.0 * summary.median_radius : 1.0;

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

Octree build_octree(const SurfelCloud& cloud, const BuildSettings& settings,
                    const Progress& progress) {
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

    // 1. Grid and order. Without any radius the spacing has to come from the order first.
    Octree octree;
    std::span<const Surfel> surfels = cloud.surfels;
    octree.grid = fit_grid(summary, cloud.origin, settings);
    const std::vector<CodeIndex> order = sorted_codes(surfels, summary, octree.grid);
    std::vector<Surfel> repaired;
    if (summary.needs_repair) {
        if (summary.median_radius == 0.0) {
            summary.median_radius = radius_from_spacing(order, octree.grid);
            octree.grid.depth = fit_grid(summary, cloud.origin, settings).depth;
        }
        repaired.assign(surfels.begin(), surfels.end());
        for (Surfel& s : repaired)
            repair(s, static_cast<float>(summary.median_radius));
        surfels = repaired;
    }
    report(1);

    // 2. Leaves, and the levels over them.
    const Leaves leaves = voxelize(surfels, order, octree.grid);
    report(3);
    NodeTree tree = build_nodes(octree.grid, leaves.codes, leaves.lobe_counts, leaves.lobes);
    octree.levels = std::move(tree.levels);
    octree.nodes = std::move(tree.nodes);
    octree.attributes = std::move(tree.attributes);
    octree.lobes = leaves.lobes;

    // 3. Points.
    pack_surfels(surfels, order, octree);
    octree.bounds_min = summary.bounds_min;
    octree.bounds_max = summary.bounds_max;
    octree.sample_count = summary.usable;
    octree.dropped_count = summary.dropped;
    octree.provenance = settings.provenance;
    write_tables(cloud.stations, cloud.area_lights, octree);
    report(5);
    return octree;
}

}  // namespace glowworm

#include "octree/sorted_surfels.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

namespace glowworm {
namespace {

constexpr std::size_t kGrain = 16384;

template <typename Body>
void for_each_index(std::size_t count, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            body(i);
    });
}

CodeIndices sorted_codes(std::span<const Surfel> surfels, const CloudSummary& summary,
                         const Grid& grid) {
    CodeIndices codes(surfels.size());
    for_each_index(surfels.size(), [&](std::size_t i) {
        codes[i] = {grid.code_of(vec3_cast<double>(surfels[i].position)),
                    static_cast<std::uint32_t>(i), 0};
    });
    if (summary.dropped > 0)
        std::erase_if(codes, [&](const CodeIndex& e) { return !is_usable(surfels[e.index]); });
    radix_sort(codes);
    return codes;
}

/// At the deepest level with four samples a cell, a surface of area A crosses about 1.5 A / h²
/// cells.
double radius_from_spacing(std::span<const CodeIndex> codes, const Grid& grid) {
    for (std::uint32_t level = kMortonLevels; level > 0; --level) {
        std::size_t cells = 1;
        for (std::size_t i = 1; i < codes.size(); ++i) {
            cells += code_at_level(codes[i].code, level) != code_at_level(codes[i - 1].code, level);
        }
        if (codes.size() < 4 * cells && level > 1) continue;
        const double edge = grid.cell_edge(level);
        const double area = static_cast<double>(cells) * edge * edge / 1.5;
        return std::sqrt(area / static_cast<double>(codes.size()) / std::numbers::pi);
    }
    return grid.cube_edge;
}

}  // namespace

double radius_from_spacing(std::span<const Surfel> surfels, const Grid& grid,
                           const CloudSummary& summary) {
    return radius_from_spacing(sorted_codes(surfels, summary, grid), grid);
}

SortedSurfels sort_surfels(std::vector<Surfel> surfels, const Grid& grid, CloudSummary& summary) {
    SortedSurfels sorted;
    sorted.codes = sorted_codes(surfels, summary, grid);
    if (summary.needs_repair && summary.median_radius == 0.0)
        summary.median_radius = radius_from_spacing(sorted.codes, grid);
    sorted.surfels.resize(sorted.codes.size());
    for_each_index(sorted.codes.size(), [&](std::size_t i) {
        if (i + kPrefetchAhead < sorted.codes.size())
            prefetch(&surfels[sorted.codes[i + kPrefetchAhead].index]);
        sorted.surfels[i] = surfels[sorted.codes[i].index];
        if (summary.needs_repair) repair(sorted.surfels[i], summary.median_radius);
        sorted.codes[i].index = static_cast<std::uint32_t>(i);
    });
    return sorted;
}

}  // namespace glowworm

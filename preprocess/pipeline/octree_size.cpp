#include "preprocess/pipeline/octree_size.h"

#include <algorithm>

#include "octree/build.h"
#include "octree/error.h"
#include "octree/octree.h"
#include "octree/size_estimate.h"

namespace glowworm {
namespace {

constexpr double kMostLeaves = 400'000.0;  // enough to tell what the others will be
constexpr double kLobesOfLarge = 1.5;      // a leaf, where leaves are large

OctreeSize size_by_places(const SurfelCloud& part, const CellSample& cells,
                          std::span<const WeightedPlace> places, const Grid& grid) {
    OctreeSize size;
    const auto inside = std::ranges::count_if(part.surfels, [&](const Surfel& surfel) {
        return cells.holds(vec3_cast<double>(surfel.position));
    });
    size.surfels = static_cast<double>(inside) * cells.stands_for();
    for (std::uint32_t level = 0; level <= grid.depth; ++level) {
        size.leaves = static_cast<double>(occupied_cells(grid, places, level));
        size.nodes += size.leaves;
    }
    size.lobes = kLobesOfLarge * size.leaves;
    return size;
}

}  // namespace

double OctreeSize::bytes(std::uint32_t links) const {
    return sizeof(PackedSurfel) * surfels + (sizeof(Node) + sizeof(NodeAttributes)) * nodes +
           static_cast<double>(sizeof(Lobe) + sizeof(std::uint32_t) * links) * lobes;
}

OctreeSize size_by_cells(const SurfelCloud& part, const CellSample& cells,
                         std::span<const WeightedPlace> places, const Grid& grid) {
    if (cells.level() > grid.depth) return size_by_places(part, cells, places, grid);
    // Leaves much smaller than the points' distance are counted from larger ones.
    const CloudSummary summary = summarize(part.surfels);
    Grid shallow = grid;
    while (shallow.depth > cells.level() && shallow.voxel_size() < 0.5 * summary.median_spacing())
        --shallow.depth;
    BuildSettings settings;
    settings.grid = shallow;
    OctreeSize size;
    double built = 0.0;
    const std::size_t count = cells.cells().size();
    for (std::size_t i = 0; i < count && size.leaves < kMostLeaves; ++i) {
        // From all over the order, which is by the number of points.
        settings.tile = cells.cells()[i * 7919 % count];
        built += 1.0;
        try {
            const Octree tile = build_octree(part, settings);
            size.surfels += static_cast<double>(tile.surfels.size());
            size.leaves += tile.levels.back().node_count;
            size.lobes += static_cast<double>(tile.lobes.size());
            for (std::size_t level = cells.level(); level < tile.levels.size(); ++level)
                size.nodes += tile.levels[level].node_count;
        } catch (const Error& error) {
            if (error.code() != ExitCode::kDegenerate) throw;  // nothing of the cell was left
        }
    }
    if (shallow.depth < grid.depth) {
        const SizeEstimate from = estimate_size(summary, shallow),
                           to = estimate_size(summary, grid);
        size.leaves *= to.leaves / from.leaves;
        size.lobes *= to.leaves / from.leaves;
        size.nodes *= to.nodes / from.nodes;
    }
    return size.times(cells.stands_for() * static_cast<double>(count) / std::max(built, 1.0));
}

}  // namespace glowworm

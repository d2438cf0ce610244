#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/grid.h"
#include "octree/lobe.h"
#include "octree/radix_sort.h"
#include "octree/shared_progress.h"
#include "octree/surfel.h"

namespace glowworm {

/// The leaves of a cloud.
struct Leaves {
    std::vector<std::uint64_t> codes;       ///< Morton codes at the grid's depth, ascending
    std::vector<std::uint8_t> lobe_counts;  ///< 1..3 a leaf
    std::vector<Lobe> lobes;
};

/// Splats surfels into the leaves of `tile`. `surfels`: finite, with positive radius, in the order
/// of `order`, their codes at level 21, ascending. Sums run in that order, so the result depends on
/// nothing else; surfels outside the tile give it the pieces of their discs that reach into it.
/// `progress` gets every surfel twice.
Leaves voxelize(std::span<const Surfel> surfels, std::span<const CodeIndex> order, const Grid& grid,
                const OctreeCell& tile, SharedProgress& progress);

/// The entries of `order` that lie in `tile`.
std::span<const CodeIndex> entries_in(std::span<const CodeIndex> order, const OctreeCell& tile);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <span>

#include "octree/surfel.h"
#include "preprocess/pipeline/cell_sample.h"

namespace glowworm {

/// How large an octree will be.
struct OctreeSize {
    double surfels = 0.0, leaves = 0.0, nodes = 0.0, lobes = 0.0;

    OctreeSize times(double factor) const {
        return {surfels * factor, leaves * factor, nodes * factor, lobes * factor};
    }
    /// Of the file, with so many links a lobe.
    double bytes(std::uint32_t links) const;
};

/// From building the chosen cells of `grid`: `part` has the surfels in and near them, relative to
/// the grid's origin. `places` are spread over the whole; they tell of leaves larger than the
/// cells.
OctreeSize size_by_cells(const SurfelCloud& part, const CellSample& cells,
                         std::span<const WeightedPlace> places, const Grid& grid);

}  // namespace glowworm

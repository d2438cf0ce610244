#pragma once

#include <span>
#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

struct MergedChunk {
    Chunk chunk;  ///< `first` is left 0
    std::vector<PackedSurfel> surfels;
};

/// Whether the points of `tiles`, neighbours in Morton order, share one chunk where they are built
/// at once. Tiles without points do not matter.
bool fit_one_chunk(std::span<const OctreeView> tiles);

/// One chunk from those of neighbouring small tiles of one grid, in Morton order, as if they had
/// been packed together: positions counted from the cell that they have in common.
MergedChunk merge_chunks(std::span<const OctreeView> tiles);

}  // namespace glowworm

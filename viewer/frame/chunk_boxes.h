#pragma once

#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

/// Holds all of a chunk's surfels, m, relative to the octree's origin.
struct ChunkBox {
    Vec3d centre, half;
};

/// [chunks] The cell that a chunk's positions count from may be far larger than what lies in it.
/// Its level-of-detail order has a point of every occupied cell of a level before the second one of
/// any: where two of the first few share a cell, the cells of the first few hold the whole chunk.
std::vector<ChunkBox> chunk_boxes(const OctreeView& octree);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

/// A node that several tiles share: their masks together, and what it holds.
struct SharedNode {
    std::uint32_t mask = 0;
    NodeAttributes attributes{};
};

/// A chunk of the joined octree: the chunks of tiles [first_tile, end_tile) in one, or as they are.
struct ChunkGroup {
    std::uint32_t first_tile, end_tile;
    bool merge;
};

/// What lies above the tiles.
struct Crown {
    std::vector<std::vector<SharedNode>> levels;  ///< [depth + 1] in Morton order
    std::vector<ChunkGroup> chunks;
};

/// Plans the join of `tiles`: sound octrees of one grid in Morton order. Throws Error (kUsage)
/// where they overlap or are not cells of the grid.
Crown build_crown(std::span<const OctreeView> tiles);

}  // namespace glowworm

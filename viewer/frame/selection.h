#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/node_layout.h"
#include "viewer/frame/view.h"

namespace glowworm {

struct SelectionSettings {
    /// Pixels between drawn surfels, > 0: what lies closer together is thinned to this.
    float quality = 0.7f;
    /// Drawn radius over stored radius, >= 1. A stored radius is that of the surfel's share of the
    /// surface; discs of random points leave exp(-k^2) of it uncovered.
    float splat_scale = 3.0f;
};

/// The first `count` surfels of a chunk, an even subsample, each grown to close the gaps.
struct ChunkSelection {
    std::uint32_t chunk;  ///< index into the octree's chunks
    std::uint32_t count;  ///< 1 .. the chunk's
    float scale;          ///< drawn radius over stored radius
};

/// The chunks that `view` can see, nearest first, thinned by distance. Nothing seen, nothing
/// returned. `origin` is the octree's, m, world.
std::vector<ChunkSelection> select_chunks(std::span<const Chunk> chunks, const Vec3d& origin,
                                          const View& view, const SelectionSettings& settings);

}  // namespace glowworm

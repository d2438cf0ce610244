#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/node_layout.h"
#include "viewer/frame/chunk_boxes.h"
#include "viewer/frame/view.h"

namespace glowworm {

struct SelectionSettings {
    /// Pixels between drawn surfels, > 0: what lies closer together is thinned to this.
    float quality = 1.0f;
    /// Drawn radius over stored radius, >= 1. A stored radius is that of the surfel's share of the
    /// surface; discs of random points leave exp(-k^2) of it uncovered.
    float splat_scale = 3.0f;
    /// Surfels in a frame at most, each chunk's share less by the same factor; 0: no limit.
    std::uint64_t most_surfels = 0;
};

/// The first `count` surfels of a chunk, an even subsample, each grown to close the gaps. Beyond
/// `full_depth` fewer of them are drawn, by the square of depth, and grown by depth.
struct ChunkSelection {
    std::uint32_t chunk;  ///< index into the octree's chunks
    std::uint32_t count;  ///< 1 .. the chunk's
    float scale;          ///< drawn radius over stored radius, up to full_depth
    float full_depth;     ///< m along the view axis; infinite: all are drawn
};

/// How many of a chunk's surfels, its first ones, stand for a `share` of it. None of an empty one.
std::uint32_t share_of(const Chunk& chunk, double share);

/// `selected` with fewer of its surfels, grown to stand for the others.
ChunkSelection thinned(const ChunkSelection& selected, std::uint32_t count);

/// Thins a selection evenly until its surfels fit into `blocks` blocks of `block_surfels` each, one
/// at least for each chunk.
void fit_into(std::vector<ChunkSelection>& selection, std::uint64_t blocks,
              std::uint32_t block_surfels);

/// The chunks that `view` can see, nearest first, thinned by distance. Nothing seen, nothing
/// returned. `boxes`: [chunks]; `origin` is the octree's, m, world.
std::vector<ChunkSelection> select_chunks(std::span<const Chunk> chunks,
                                          std::span<const ChunkBox> boxes, const Vec3d& origin,
                                          const View& view, const SelectionSettings& settings);

}  // namespace glowworm

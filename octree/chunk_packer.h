#pragma once

#include <functional>
#include <span>
#include <vector>

#include "octree/chunk.h"
#include "octree/shared_progress.h"

namespace glowworm {

/// Packs surfels in Morton order, chunk after chunk.
class ChunkPacker {
  public:
    /// `order`: codes at level 21, ascending, and places in `surfels`. Both must outlive it.
    ChunkPacker(std::span<const Surfel> surfels, std::span<const CodeIndex> order,
                const Grid& grid);

    std::size_t chunks() const { return ranges_.size(); }

    using Take = std::function<void(const Chunk& chunk, std::span<const PackedSurfel> surfels)>;

    /// Hands over every chunk with its points, in order and one at a time, while other threads pack
    /// the next ones: what `take` does with them (writing) costs no time of its own.
    void pack(SharedProgress& progress, const Take& take) const;

  private:
    std::span<const Surfel> surfels_;
    std::span<const CodeIndex> order_;
    Grid grid_;
    std::vector<SurfelRange> ranges_;
};

}  // namespace glowworm

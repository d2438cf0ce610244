#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "viewer/frame/selection.h"
#include "viewer/frame/surfel_reader.h"
#include "viewer/gpu/objects.h"

namespace glowworm {

/// The part of the cloud that is on the GPU: of every chunk its first surfels, an even subsample,
/// in blocks that lie anywhere in pages. The first block of every chunk is always there, so that
/// nothing is a hole; more comes when frames ask for it, and goes when others need its place.
class SurfelCache {
  public:
    static constexpr std::uint32_t kBlock = 256;  ///< surfels; a chunk's last may hold fewer

    struct Place {
        std::uint32_t page;
        std::uint32_t first;  ///< surfel, counted from the page's start
    };

    /// The octree must outlive it. `max_page_bytes` is the context's limit for one binding;
    /// `max_bytes` is what all pages may take, 0: what the cloud does. At least every chunk's first
    /// block is held.
    SurfelCache(const OctreeView& octree, std::size_t max_page_bytes, std::uint64_t max_bytes = 0);

    /// Blocks that a frame which shows `shown` chunks can have, with the others' first ones.
    std::uint64_t blocks_for(std::size_t shown) const;

    /// From here on chunks that no frame since has asked for give up their places first.
    void begin_frame() { ++frames_; }
    /// Brings all of `selection` here, at once. It must fit, with what was asked for since
    /// begin_frame().
    void load(std::span<const ChunkSelection> selection);
    /// Takes in what has been read since the last time and asks for what `selection` still lacks:
    /// what is coarsest first, nearer chunks before others. True where it lacks nothing.
    bool request(std::span<const ChunkSelection> selection);

    /// How many of a chunk's surfels are here, its first ones.
    std::uint32_t resident(std::uint32_t chunk) const;
    Place place_of(std::uint32_t chunk, std::uint32_t block) const;
    const std::vector<Buffer>& pages() const { return pages_; }

  private:
    struct Resident {
        std::vector<std::uint32_t> slots;  // of its first blocks
        std::uint32_t under_way = 0;       // blocks
        std::uint32_t wanted = 1;          // blocks, by the frame that last had it
        std::uint64_t used_at = 0;         // that frame's number
    };

    std::span<const PackedSurfel> surfels_of(std::uint32_t chunk, std::uint32_t first_block,
                                             std::size_t blocks) const;
    std::vector<std::uint32_t> take_slots(std::size_t count);
    void make_room(std::size_t blocks);
    void keep_first(std::uint32_t chunk, std::size_t blocks);
    void put(std::span<const PackedSurfel> surfels, std::span<const std::uint32_t> slots);
    void take_in(std::vector<SurfelRun> runs);
    void note(std::span<const ChunkSelection> selection);

    OctreeView octree_;
    std::uint32_t page_blocks_;
    std::uint64_t capacity_;  // blocks
    std::vector<Buffer> pages_;
    std::vector<std::uint32_t> free_;  // slots, taken from the end
    std::vector<Resident> chunks_;
    std::uint64_t frames_ = 0;
    SurfelReader reader_;
};

}  // namespace glowworm

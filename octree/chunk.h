#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/grid.h"
#include "octree/node_layout.h"
#include "octree/radix_sort.h"
#include "octree/surfel.h"

namespace glowworm {

/// Deepest cell a chunk's box may be: positions are then counted in 2^-31 of the root's edge, finer
/// than the floats they came from.
inline constexpr std::uint32_t kMaxChunkLevel = 15;

/// Levels of a quantised position below its chunk's box.
inline constexpr std::uint32_t kCodeLevels = 16;

struct SurfelRange {
    std::uint64_t begin, end;
    std::uint64_t size() const { return end - begin; }
};

/// A chunk's positions are good to 1/16 of the distance between its points where these lie densest:
/// of 17 points no two may be nearer than a 512th of the box in all three axes, unless the box is
/// as small as that of level kFinestNeededLevel, when positions are finer than floats.
inline constexpr std::size_t kDensePoints = 17;
inline constexpr std::uint32_t kDenseLevels = 9;
inline constexpr std::uint32_t kFinestNeededLevel = 12;

/// The level of the largest box that is fine enough for surfels: 0..kFinestNeededLevel. `codes`: at
/// level 21, ascending. That of neighbouring cells together is the deeper one of theirs.
std::uint32_t needed_box_level(std::span<const CodeIndex> codes);

/// Level of the smallest cell that may be the box of surfels whose codes, at level 21, go from
/// `first` to `last`.
std::uint32_t box_level_of(std::uint64_t first, std::uint64_t last);

/// Cuts surfels in Morton order into chunks of at most kMaxChunkSurfels whose boxes are as small as
/// they need to be. A cell that holds more is split; of its children, neighbours in Morton order
/// share a chunk while they fit in one. `order` is at level 21, ascending. Below level 21 it alone
/// decides.
std::vector<SurfelRange> split_into_chunks(std::span<const CodeIndex> order);

/// A chunk's level-of-detail order. `codes`: [n] Morton codes of 16 levels, ascending. Returns the
/// [n] places, coarsest first: for every level, all cells that are occupied at that level have one
/// point before the level's end, the one nearest to the cell's centre among its children's; inside
/// a level the order is the bit-reversed one, which spreads evenly along the Morton curve.
std::vector<std::uint32_t> detail_order(std::span<const std::uint64_t> codes);

/// Puts a chunk's surfels, in any order, into their order in the file, which depends on their bytes
/// alone, and describes them. `box_level`: level of the chunk's box, lower corner `box`.
Chunk arrange_chunk(std::span<PackedSurfel> surfels, const Grid& grid, const CellIndex& box,
                    std::uint32_t box_level);

/// Packs `range` of `order` into `out` (as long as the range) and describes it; `first` is left 0.
Chunk pack_chunk(std::span<const Surfel> surfels, std::span<const CodeIndex> range,
                 const Grid& grid, std::span<PackedSurfel> out);

/// What a shader reads back; normal of unit length, emission not stored.
Surfel unpack_surfel(const Chunk& chunk, const PackedSurfel& packed);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

/// Which cells of an octree hold a leaf, for walks that ask at every step: a table of all cells of
/// a coarse level, and for each that is not empty eight bricks of 4x4x4 cells, a bit each. A walk
/// reads two small records where a descent from the root reads a node per level. In deep octrees
/// each of a brick's cells has eight bricks in turn. Cells have coordinates in leaf edges.
struct Occupancy {
    /// Bits are in Morton order: eight siblings are a byte.
    struct Brick {
        std::uint32_t cells[2];  ///< 64 bits: cells that are not empty
        std::uint32_t first;     ///< leaf (counted in Morton order) or bricks of the first of them
        std::int32_t size;       ///< leaf edges a cell; empty siblings are one cell of twice that
    };

    std::int32_t table_level = 0;      ///< octree level of the table's cells
    std::int32_t table_shift = 3;      ///< levels below it, a multiple of 3; at least 3
    std::vector<std::uint32_t> table;  ///< [8^table_level] first of each cell's bricks, x fastest
    std::vector<Brick> bricks;

    /// Cells of `brick` that are not empty and come before the one at `bit`.
    static std::uint32_t before(const Brick& brick, std::uint32_t bit);
};

/// Of an octree with at least one node.
Occupancy make_occupancy(const OctreeView& octree);

inline std::uint32_t Occupancy::before(const Brick& brick, std::uint32_t bit) {
    const std::uint64_t cells = std::uint64_t{brick.cells[1]} << 32 | brick.cells[0];
    std::uint64_t bits = cells & ((std::uint64_t{1} << bit) - 1u);
    // std::popcount is a call where the processor is any x86-64.
    bits -= bits >> 1 & 0x5555555555555555u;
    bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
    bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
    return static_cast<std::uint32_t>(bits * 0x0101010101010101u >> 56);
}

}  // namespace glowworm

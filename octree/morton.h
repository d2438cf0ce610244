#pragma once

#include <cstdint>

namespace glowworm {

/// Levels of a full Morton code: 21 bits an axis, 63 in all, x in the lowest bit of each triple.
inline constexpr std::uint32_t kMortonLevels = 21;

/// Spreads the low 21 bits of `v` to every third bit.
constexpr std::uint64_t spread_by_three(std::uint64_t v) {
    v &= 0x1fffff;
    v = (v | v << 32) & 0x001f00000000ffff;
    v = (v | v << 16) & 0x001f0000ff0000ff;
    v = (v | v << 8) & 0x100f00f00f00f00f;
    v = (v | v << 4) & 0x10c30c30c30c30c3;
    v = (v | v << 2) & 0x1249249249249249;
    return v;
}

/// Gathers every third bit of `v` into the low 21 bits: the inverse of spread_by_three.
constexpr std::uint32_t gather_by_three(std::uint64_t v) {
    v &= 0x1249249249249249;
    v = (v | v >> 2) & 0x10c30c30c30c30c3;
    v = (v | v >> 4) & 0x100f00f00f00f00f;
    v = (v | v >> 8) & 0x001f0000ff0000ff;
    v = (v | v >> 16) & 0x001f00000000ffff;
    v = (v | v >> 32) & 0x00000000001fffff;
    return static_cast<std::uint32_t>(v);
}

/// A cell's integer coordinates at some level.
struct CellIndex {
    std::uint32_t x = 0, y = 0, z = 0;
    friend constexpr bool operator==(const CellIndex&, const CellIndex&) = default;
};

/// Morton code of a cell with 21-bit coordinates. The octant inside a parent is code & 7 =
/// x + 2y + 4z; the parent's code is code >> 3.
constexpr std::uint64_t morton_encode(const CellIndex& cell) {
    return spread_by_three(cell.x) | spread_by_three(cell.y) << 1 | spread_by_three(cell.z) << 2;
}

constexpr CellIndex morton_decode(std::uint64_t code) {
    return {gather_by_three(code), gather_by_three(code >> 1), gather_by_three(code >> 2)};
}

/// The code at `level` of the cell that holds a full code (of level 21).
constexpr std::uint64_t code_at_level(std::uint64_t full_code, std::uint32_t level) {
    return full_code >> (3 * (kMortonLevels - level));
}

/// A cell of the octree at some level; the root by default.
struct OctreeCell {
    std::uint32_t level = 0;
    std::uint64_t code = 0;  ///< Morton code at that level

    /// Full codes (of level 21) inside are [first_code, end_code).
    constexpr std::uint64_t first_code() const { return code << 3 * (kMortonLevels - level); }
    constexpr std::uint64_t end_code() const { return (code + 1) << 3 * (kMortonLevels - level); }
    constexpr bool holds(std::uint64_t full_code) const {
        return code_at_level(full_code, level) == code;
    }
    friend constexpr bool operator==(const OctreeCell&, const OctreeCell&) = default;
};

}  // namespace glowworm

#pragma once

#include <cstdint>

#include "octree/vec3.h"

namespace glowworm {

/// The octree's root cube and its leaf level.
struct Grid {
    Vec3d origin;           ///< m, world; all else is relative to it
    Vec3f cube_min;         ///< m: the root cell's lower corner
    float cube_edge = 1.0f; ///< m
    std::uint32_t depth = 0;///< level of the leaves, 0..21; the root is level 0

    /// Edge of a cell at `level`, m.
    float cell_edge(std::uint32_t level) const {
        return cube_edge / static_cast<float>(std::uint64_t{1} << level);
    }
    float voxel_size() const { return cell_edge(depth); }
};

}  // namespace glowworm

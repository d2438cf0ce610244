#pragma once

#include <algorithm>
#include <cstdint>

#include "octree/morton.h"
#include "octree/vec3.h"

namespace glowworm {

/// The octree's root cube and its leaf level.
struct Grid {
    Vec3d origin;             ///< m, world; all else is relative to it
    Vec3f cube_min;           ///< m: the root cell's lower corner
    float cube_edge = 1.0f;   ///< m
    std::uint32_t depth = 0;  ///< level of the leaves, 0..21; the root is level 0

    /// Edge of a cell at `level`, m.
    float cell_edge(std::uint32_t level) const {
        return cube_edge / static_cast<float>(std::uint64_t{1} << level);
    }
    float voxel_size() const { return cell_edge(depth); }

    /// Lower corner of a cell at `level`, m, relative to origin.
    Vec3d cell_min(const CellIndex& cell, std::uint32_t level) const {
        const double edge = cell_edge(level);
        return vec3_cast<double>(cube_min) + Vec3d{static_cast<double>(cell.x),
                                                   static_cast<double>(cell.y),
                                                   static_cast<double>(cell.z)} *
                                                 edge;
    }

    /// `position` (m, relative to origin) in cells of level 21, each in [0, 2^21); what lies
    /// outside the cube is moved to its side.
    Vec3d finest_coordinates(const Vec3d& position) const {
        constexpr double kCells = 1u << kMortonLevels;
        constexpr double kLimit = kCells - 1.0 / 65536.0;
        const double scale = kCells / cube_edge;
        const auto axis = [&](double p, float lower) {
            return std::clamp((p - lower) * scale, 0.0, kLimit);
        };
        return {axis(position.x, cube_min.x), axis(position.y, cube_min.y),
                axis(position.z, cube_min.z)};
    }

    /// Morton code at level 21.
    std::uint64_t code_of(const Vec3d& position) const {
        const Vec3d at = finest_coordinates(position);
        return morton_encode({static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y),
                              static_cast<std::uint32_t>(at.z)});
    }
};

}  // namespace glowworm

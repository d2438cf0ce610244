#pragma once

#include <cstdint>
#include <vector>

#include "octree/octree.h"

namespace glowworm {

/// A node of one level, as a point that other tools can look at.
struct Voxel {
    Vec3f centre;          ///< m, relative to the grid's origin
    float opacity = 0.0f;  ///< 0..1
    float area = 0.0f;     ///< m²
    Vec3f ndf;             ///< mean normal; its length is the Toksvig length
    Vec3f albedo;          ///< linear
};

/// All nodes of `level` in Morton order. Throws Error (kUsage) for a level below the leaves.
/// `octree` must be sound.
std::vector<Voxel> extract_level(const OctreeView& octree, std::uint32_t level);

/// A box in metres relative to the grid's origin, corners included.
struct Box {
    Vec3f lower, upper;
    bool holds(const Vec3f& p) const {
        return p.x >= lower.x && p.y >= lower.y && p.z >= lower.z && p.x <= upper.x &&
               p.y <= upper.y && p.z <= upper.z;
    }
};

/// The part of an octree inside a box, on the same grid: the lobes whose mean positions lie in it
/// and the points that do. Chunks keep their boxes and what is left of their order; links are left
/// out. Throws Error (kDegenerate) where the box has no surface. `octree` must be sound.
Octree cut_box(const OctreeView& octree, const Box& box);

/// Morton codes of all nodes of `level`, ascending, from the tree itself.
std::vector<std::uint64_t> codes_of_level(const OctreeView& octree, std::uint32_t level);

}  // namespace glowworm

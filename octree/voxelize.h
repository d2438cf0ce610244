#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/grid.h"
#include "octree/lobe.h"
#include "octree/radix_sort.h"
#include "octree/surfel.h"

namespace glowworm {

/// How a surfel is laid over voxels: as a disc of `pieces` equal areas. The disc is as large as the
/// area it stands for, and up to twice as wide where samples are so sparse (area above 0.44 voxel
/// faces) that discs of their own area would leave holes.
struct Splat {
    std::uint32_t rings = 0;   ///< 0: a point, else concentric rings around it
    std::uint32_t pieces = 1;  ///< 1 + 3 rings (rings + 1)
    double radius = 0.0;       ///< m: of the disc
    double area = 0.0;         ///< m²: of the whole, whatever the disc's radius
};

/// Most rings of a splat: pieces lie at most a quarter of a voxel apart up to discs of 1.7 voxels in
/// radius, and further apart beyond.
inline constexpr std::uint32_t kMaxSplatRings = 7;

Splat splat_of(const Surfel& surfel, double voxel);

/// Position of a splat's piece, m, relative to the grid's origin. Piece 0 is the surfel itself.
Vec3d piece_position(const Surfel& surfel, const Splat& splat, std::uint32_t piece);

/// The leaves of a cloud.
struct Leaves {
    std::vector<std::uint64_t> codes;       ///< Morton codes at the grid's depth, ascending
    std::vector<std::uint8_t> lobe_counts;  ///< 1..3 a leaf
    std::vector<Lobe> lobes;
};

/// Splats surfels into the leaves of `tile`. `order`: the surfels' codes at level 21, sorted;
/// `index` points into `surfels`, all of which are finite with positive radius at most
/// `largest_radius` (m). Sums run in that order, so the result depends on nothing else; surfels
/// outside the tile give it the pieces of their discs that reach into it.
Leaves voxelize(std::span<const Surfel> surfels, std::span<const CodeIndex> order, const Grid& grid,
                double largest_radius, const OctreeCell& tile = {});

/// The entries of `order` that lie in `tile`.
std::span<const CodeIndex> entries_in(std::span<const CodeIndex> order, const OctreeCell& tile);

}  // namespace glowworm

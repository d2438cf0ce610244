#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "octree/grid.h"
#include "octree/lobe.h"
#include "octree/surfel.h"

namespace glowworm {

/// How a surfel is laid over voxels: as a disc of `pieces` equal areas. The disc is as large as the
/// area it stands for, and up to twice as wide where samples are so sparse (area above 0.25 voxel
/// faces) that discs of their own area would leave holes.
struct Splat {
    std::uint32_t rings = 0;   ///< 0: a point, else concentric rings around it
    std::uint32_t pieces = 1;  ///< 1 + 3 rings (rings + 1)
    double radius = 0.0;       ///< of the disc, in leaf edges
};

/// Most rings of a splat: pieces lie at most a quarter of a voxel apart up to discs of 1.7 voxels
/// in radius, and further apart beyond.
inline constexpr std::uint32_t kMaxSplatRings = 7;
inline constexpr std::size_t kMaxPieces = 1 + 3 * kMaxSplatRings * (kMaxSplatRings + 1);

/// `radius`: of the surfel, in leaf edges.
Splat splat_of(double radius);

/// Which pieces of a disc lie in one leaf: a bit each where a disc has at most 19, else how many
/// they are and which is the first.
using PieceSet = std::uint32_t;

struct DiscPart {
    CellIndex leaf;
    PieceSet pieces = 0;
};
using DiscParts = std::array<DiscPart, kMaxPieces>;

/// The root cube in leaf edges.
struct LeafGrid {
    explicit LeafGrid(const Grid& grid);

    /// Exactly where Grid::code_of finds a position (m), which lies outside at its side.
    Vec3d at(const Vec3f& position) const {
        const auto axis = [&](float p, double lower) {
            return std::clamp((p - lower) * leaves_per_metre, 0.0, last);
        };
        return {axis(position.x, cube_min.x), axis(position.y, cube_min.y),
                axis(position.z, cube_min.z)};
    }

    Vec3d cube_min;  ///< m
    double leaves_per_metre;
    double leaves;  ///< along an edge
    double last;    ///< farthest coordinate inside
};

/// A surfel's splat as it lies over the leaves of a grid. Lengths are in leaf edges, counted from
/// the root cube's lower corner.
class Disc {
  public:
    Disc(const Surfel& surfel, const LeafGrid& grid);  ///< `grid` must outlive it

    std::uint32_t pieces() const { return splat_.pieces; }

    /// Where a piece is; what sticks out of the root cube is moved to its side, so that area is
    /// conserved. Piece 0 is the surfel itself.
    Vec3d at(std::uint32_t piece) const;

    /// Finds the leaves that have pieces, the surfel's own first, and returns how many they are.
    std::size_t cut(DiscParts& parts) const;

    /// Adds a part to the sums of its leaf. `surfel` is the one that this disc is of.
    void add_to(LeafSums& sums, const Surfel& surfel, const DiscPart& part) const;

  private:
    bool is_inside_one_leaf() const;
    bool is_inside_cube() const;
    std::size_t cut_small(DiscParts& parts) const;
    std::size_t cut_any(DiscParts& parts) const;
    PieceMoments moments_of(const DiscPart& part) const;

    const LeafGrid& grid_;
    Splat splat_;
    Vec3d centre_;
    CellIndex leaf_;  ///< the surfel's own
    Vec3d u_, v_;     ///< along the disc, as long as its radius
};

}  // namespace glowworm

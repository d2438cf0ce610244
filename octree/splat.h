#pragma once

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
    double radius = 0.0;       ///< m: of the disc
    double area = 0.0;         ///< m²: of the whole, whatever the disc's radius
};

/// Most rings of a splat: pieces lie at most a quarter of a voxel apart up to discs of 1.7 voxels
/// in radius, and further apart beyond.
inline constexpr std::uint32_t kMaxSplatRings = 7;

Splat splat_of(const Surfel& surfel, double voxel);

/// Position of a splat's piece, m, relative to the grid's origin. Piece 0 is the surfel itself.
Vec3d piece_position(const Surfel& surfel, const Splat& splat, std::uint32_t piece);

/// Whether all of a splat surely lies in the leaf of its surfel.
bool stays_inside(const Surfel& surfel, const Splat& splat, const Grid& grid);

/// Lays one disc after the other over the leaves: where its pieces are and in which leaf each.
class DiscPieces {
  public:
    explicit DiscPieces(const Grid& grid);  ///< `grid` must outlive it

    void place(const Surfel& surfel);

    /// The surfel's own leaf is that of piece 0.
    const CellIndex& cell(std::uint32_t piece) const { return cells_[piece]; }

    /// Adds the pieces of `surfel`, the one placed last, that lie in the same leaf as piece
    /// `first`, all at once.
    void add_to(LeafSums& leaf, const Surfel& surfel, std::uint32_t first);

    /// Calls `visit(piece)` with the first piece in each leaf but the surfel's own.
    template <typename Visit>
    void for_each_other_leaf(const Visit& visit) const {
        for (std::uint32_t i = 1; i < splat_.pieces; ++i) {
            bool first = true;
            for (std::uint32_t j = 0; j < i && first; ++j)
                first = !(cells_[j] == cells_[i]);
            if (first) visit(i);
        }
    }

  private:
    static constexpr std::size_t kMaxPieces = 1 + 3 * kMaxSplatRings * (kMaxSplatRings + 1);

    const Grid& grid_;
    double voxel_;
    std::uint32_t shift_;
    Vec3d lower_, upper_;
    Splat splat_;
    std::array<Vec3d, kMaxPieces> positions_, inside_;
    std::array<CellIndex, kMaxPieces> cells_;
};

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/grid.h"
#include "octree/surfel.h"

namespace glowworm {

/// Bytes that building takes on behalf of one surfel: itself, its codes, what is packed of it, and
/// the leaves that its disc may make.
std::uint64_t bytes_to_build(const Surfel& surfel, const Grid& grid);

/// Which part of a cell of the grid is how heavy: bytes_to_build, summed over its cells up to seven
/// levels down.
class CellWeights {
  public:
    CellWeights(const Grid& grid, const OctreeCell& root);
    void add(const Surfel& surfel);
    std::uint64_t total() const;

    const Grid& grid() const { return grid_; }
    const OctreeCell& root() const { return root_; }
    std::uint32_t level() const { return level_; }
    std::span<const std::uint64_t> weights() const { return weights_; }  ///< by Morton code

  private:
    Grid grid_;
    OctreeCell root_;
    std::uint32_t level_;
    std::vector<std::uint64_t> weights_;
};

/// A cell of the grid cut into cells that can be built one at a time.
class Tiling {
  public:
    /// Throws Error (kBudget) where a cell that cannot be cut any more weighs more than `capacity`
    /// bytes; the sentence says what it needs on top of `fixed`.
    Tiling(const CellWeights& weights, std::uint64_t capacity, std::uint64_t fixed);

    std::span<const OctreeCell> tiles() const { return tiles_; }  ///< in Morton order

    /// The tiles that a surfel's disc reaches, its own first; none outside the root.
    void find(const Surfel& surfel, std::vector<std::uint32_t>& reached) const;

  private:
    void cut(const CellWeights& weights, OctreeCell cell, std::uint64_t capacity,
             std::uint64_t fixed);

    Grid grid_;
    OctreeCell root_;
    std::uint32_t level_;
    std::vector<OctreeCell> tiles_;
    std::vector<std::uint32_t> tile_of_cell_;  ///< by Morton code inside the root
};

/// Whether a surfel's disc reaches into a cell.
bool reaches(const Surfel& surfel, const Grid& grid, const OctreeCell& cell);

}  // namespace glowworm

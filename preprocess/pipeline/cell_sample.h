#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/grid.h"

namespace glowworm {

/// A place and how many points of a cloud it stands for.
struct WeightedPlace {
    Vec3d position;  ///< m, relative to the grid's origin
    double points = 1.0;
};

/// Some cells of a grid that stand for all cells a cloud occupies: sparse and dense ones in the
/// proportion in which there are any.
class CellSample {
  public:
    /// Chooses cells with about `points` points in them, all of the grid where there are no more.
    CellSample(const Grid& grid, std::span<const WeightedPlace> places, double points);

    std::span<const OctreeCell> cells() const { return cells_; }
    std::uint32_t level() const { return level_; }

    /// How many times as many cells are occupied as were chosen.
    double stands_for() const { return stands_for_; }

    bool holds(const Vec3d& position) const;

    /// Whether a chosen cell is within `margin` metres, at most the edge of one.
    bool is_near(const Vec3d& position, double margin) const;

    /// Edge of a cell, m.
    double edge() const { return grid_.cell_edge(level_); }

  private:
    Grid grid_;
    std::uint32_t level_ = 0;
    std::vector<OctreeCell> cells_;
    std::vector<bool> chosen_;  // by Morton code at the level
    double stands_for_ = 1.0;
};

/// How many cells of a level hold any of the places.
std::size_t occupied_cells(const Grid& grid, std::span<const WeightedPlace> places,
                           std::uint32_t level);

}  // namespace glowworm

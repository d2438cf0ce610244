#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "octree/vec3.h"

namespace glowworm {

/// Directions sorted into the cells of a cube's six faces, `resolution` x `resolution` each. No
/// poles, so that a tilted or rolled scanner sees cells of the same size (within a factor of 5 in
/// solid angle).
struct CubeMap {
    std::uint32_t resolution;

    explicit CubeMap(std::uint32_t cells_per_edge) : resolution(cells_per_edge) {}
    std::size_t size() const { return std::size_t{6} * resolution * resolution; }

    /// Cell of a direction of any length above 0.
    std::uint32_t cell(const Vec3f& direction) const;

    /// Calls `visit(cell)` for the cell and its up to 8 neighbours on the same face.
    template <typename Visit>
    void for_ring(std::uint32_t cell, Visit visit) const {
        const std::uint32_t face = cell / (resolution * resolution);
        const std::uint32_t v = cell / resolution % resolution, u = cell % resolution;
        for (std::uint32_t y = v == 0 ? 0 : v - 1; y <= v + 1 && y < resolution; ++y) {
            for (std::uint32_t x = u == 0 ? 0 : u - 1; x <= u + 1 && x < resolution; ++x) {
                visit((face * resolution + y) * resolution + x);
            }
        }
    }
};

/// What a station says of a place.
enum class Seen {
    kUnknown,  ///< not looked at
    kFree,     ///< a ray passed through: what it hit lies behind
    kSurface,  ///< about where its surface is
    kHidden,   ///< behind what it saw
};

/// How far a station saw in each direction: the nearest and the farthest point per cell.
class DepthImage {
  public:
    /// `positions` in the station's frame, m. The cells are sized so that they hold about
    /// `points_per_cell` points each. Empty in: everything is kUnknown.
    explicit DepthImage(std::span<const Vec3f> positions, double points_per_cell = 3.0);

    /// `place` in the station's frame. Free means nearer by more than `margin` metres than the
    /// nearest point of its cell and the cells around it, so that edges and slanted surfaces do
    /// not look like contradictions.
    Seen at(const Vec3f& place, float margin) const;

    /// Width of a cell, radians.
    double cell_width() const;

  private:
    struct Depths {
        float nearest, farthest;  ///< m; nearest > farthest: an empty cell
    };
    CubeMap map_;
    std::vector<Depths> own_;     ///< [cell]
    std::vector<Depths> around_;  ///< [cell], with the cells around it
};

}  // namespace glowworm

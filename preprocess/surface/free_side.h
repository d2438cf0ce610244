#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/surface/normals.h"

namespace glowworm {

/// For points whose side is unknown: which is the free one. Rays leave both sides of a point and
/// march through the cloud's coarse occupancy; on the passage's side they end on a surface that is
/// turned toward them or away, behind it they mostly run out into rock that nobody saw.
class FreeSide {
  public:
    /// Cells of `cell` metres, at least 2^21 to a side of the cloud.
    FreeSide(const SurfacePoints& points, float cell);

    /// Rays that ended on a surface on the side of `normal`, minus those behind, of point i; each
    /// between 0 and kRays.
    int vote(std::size_t i, const Vec3f& normal) const;

    static constexpr int kRays = 5;

  private:
    bool is_occupied(const Vec3d& cell) const;

    const SurfacePoints* points_;
    Vec3d low_;
    double cell_;
    int steps_;
    std::vector<std::uint64_t> codes_;  // sorted Morton codes of occupied cells
};

}  // namespace glowworm

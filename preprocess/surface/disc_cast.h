#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/surface/normals.h"

namespace glowworm {

/// The surface as rays meet it: a disc around every point that has a plane, wide enough to close
/// the gaps between points. The tree of the points bounds the discs. Keeps references.
class DiscCast {
  public:
    DiscCast(const SurfacePoints& points, const std::vector<LocalPlane>& planes);

    struct Hit {
        std::uint32_t point = kNoNeighbour;  ///< in tree order; kNoNeighbour: the ray left
        float distance = 0.0f;               ///< m
    };

    /// The first disc along the ray from `from` (m) in the unit `direction` that lies between
    /// `nearest` and `farthest` metres away.
    Hit first(const Vec3f& from, const Vec3f& direction, float nearest, float farthest) const;

    /// m: rays that leave point i should look beyond this, for its own surface to be behind them;
    /// `cosine` between the ray and the plane's normal, > 0.
    float clearance(std::size_t i, float cosine) const;

  private:
    const SurfacePoints& points_;
    const std::vector<LocalPlane>& planes_;
    std::vector<float> widest_;  // m, per node of the tree: the largest disc
};

}  // namespace glowworm

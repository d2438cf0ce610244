#pragma once

#include <cstddef>
#include <vector>

#include "octree/octree_file.h"
#include "shaders/gpu_layout.h"
#include "viewer/gpu/objects.h"
#include "viewer/gpu/program.h"
#include "viewer/light/settings.h"

namespace glowworm {

/// The cones over a hemisphere: x: sin² of the angle to the normal, y: azimuth in turns, z:
/// diameter of the footprint per length, w: weight; weights sum to 1. Under `faithful` the usual
/// six of 60° (one along the normal with weight 1/4, five at 60° with 3/20); else `count` sectors
/// of equal cosine-weighted area in rings, and of their aperture the part that keeps light from
/// smearing. Throws Error (kUsage) for a count other than 4, 5, 6, 9, 10 or 16.
std::vector<gpu::vec4> cone_set(int count, bool faithful);

/// The paper's gather: radiance and opacity filtered up the octree as seen from six sides, and
/// cones through them.
class ConeGather {
  public:
    ConeGather(const OctreeView& octree, const LightSettings& settings);

    /// Filters what is bound at BINDING_RADIANCE up the octree.
    void filter() const;
    /// What filter() made, and where nodes lie, for what is compiled (sides.glsl).
    const Buffer& sides() const { return sides_; }
    const Buffer& coarse_cells() const { return dense_; }
    /// Gathers into what is bound at BINDING_SCRATCH_B.
    void gather() const;

  private:
    std::vector<Level> levels_;
    std::size_t lobes_;
    std::vector<gpu::vec4> cones_;
    Buffer sides_, dense_;
    Program filter_leaves_, filter_nodes_, gather_;
};

}  // namespace glowworm

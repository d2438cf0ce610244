#pragma once

#include <span>
#include <vector>

#include "octree/vec3.h"

namespace glowworm::testing {

/// Normals ([n] unit, of either sign) by pcl::NormalEstimationOMP with `k` neighbours and
/// `threads`.
std::vector<Vec3f> pcl_normals(std::span<const Vec3f> positions, int k, int threads);

}  // namespace glowworm::testing

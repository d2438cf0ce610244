#pragma once

#include <span>
#include <vector>

#include "octree/vec3.h"

namespace glowworm::bench {

/// Normals ([n] unit, of either sign) by CGAL::pca_estimate_normals with `k` neighbours, in
/// parallel.
std::vector<Vec3f> cgal_normals(std::span<const Vec3f> positions, int k);

}  // namespace glowworm::bench

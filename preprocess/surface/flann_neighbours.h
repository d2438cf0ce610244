#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/surface/point_tree.h"

namespace glowworm {

/// What nearest_neighbours finds, found by FLANN's k-d tree: the reference it is tested against.
/// Ties in distance come in FLANN's order.
std::vector<std::uint32_t> flann_neighbours(const PointTree& tree, int count, float radius);

}  // namespace glowworm

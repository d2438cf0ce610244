#pragma once

#include <optional>

#include "octree/octree_file.h"

namespace glowworm {

inline constexpr double kHeadHeight = 1.6;  // m: a walker's eyes over the floor

/// How far above the floor a walker's eyes are under a ceiling `clearance` m above that floor:
/// kHeadHeight where there is room, else stooping or crawling, in the upper part of what there is.
double eye_height(double clearance);

/// A height on its way from `z` to `wanted` after `seconds`: steps are climbed in about a third of
/// a second, without a jump.
double stepped_height(double z, double wanted, double seconds);

/// Where a walker's eyes should be above the floor beneath `position`, m, world; nothing where no
/// floor is beneath.
std::optional<double> walking_height(const OctreeView& octree, const Vec3d& position);

}  // namespace glowworm

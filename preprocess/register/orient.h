#pragma once

#include <span>
#include <vector>

#include "preprocess/kd_tree.h"

namespace glowworm {

/// Turns each normal toward `viewpoint`.
void face_viewpoint(std::span<const Vec3f> positions, std::span<Vec3f> normals,
                    const Vec3f& viewpoint);

/// Makes normals agree with their neighbours' along a minimum spanning tree of 1 - |n·m| (Hoppe et
/// al. 1992), then turns each connected piece so that its normals point away from the middle of
/// all points. For clouds that were not seen from one place. `tree` is over `positions`.
void agree_with_neighbours(std::span<const Vec3f> positions, std::span<Vec3f> normals,
                           const KdTree& tree);

}  // namespace glowworm

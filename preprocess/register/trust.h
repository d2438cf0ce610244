#pragma once

#include <vector>

#include "preprocess/poses.h"
#include "preprocess/register/refine.h"

namespace glowworm {

/// Below this share of the surface's weight a direction counts as weak. A room holds each direction
/// with about 1/3, a winding passage with 0.003 and more, a straight bare tunnel with no more than
/// the noise of its normals (measured: 0.00003 at 3 mm range noise).
inline constexpr double kWeakInformation = 0.002;

/// The motions that the surfaces in common leave nearly undetermined: eigenvectors of the
/// information per unit weight, turns measured by the arc they make at the inliers' rms distance,
/// so that all six compare. Axes in the target's frame. A fit without inliers: none.
std::vector<WeakAxis> weak_axes(const Fit& fit);

/// `axes` turned by the rotation of `T_world_target`.
std::vector<WeakAxis> rotate(std::vector<WeakAxis> axes, const Eigen::Isometry3d& T_world_target);

}  // namespace glowworm

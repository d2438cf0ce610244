#pragma once

#include <optional>
#include <span>

#include "preprocess/register/scan_model.h"

namespace glowworm {

/// Samples of `positions` at `spacing` metres for fine alignment: each lies on, and takes its
/// normal and its variance from, a quadric fitted to the points around it (a height field over
/// their best plane, as in moving least squares: Levin 1998, Alexa et al. 2003). A plane fit would
/// pull samples of a curved wall toward the hollow side, the more the sparser its points, so that
/// two scans that see the wall from different distances would settle apart. The neighbourhood grows
/// until it holds enough points; where they leave the place open (an edge of what was seen, a
/// crease) the variance says so. Samples without enough neighbours are left out. Normals face
/// `viewpoint`, else they agree with their neighbours'.
SurfaceSamples sample_patches(std::span<const Vec3f> positions, double spacing,
                              const std::optional<Vec3f>& viewpoint);

}  // namespace glowworm

#pragma once

#include <span>
#include <vector>

#include "preprocess/surface/normals.h"

namespace glowworm {

/// An NDF vector is the mean of unit normals: its direction is the surface's, its length says how
/// much they spread (Fournier 1992; Toksvig 2004, "Mipmapping Normal Maps"). Means of means,
/// weighted by area, are exact, so the octree merges them by adding.
///
/// With v the variance of the surface's slope along one axis:
///   length = 1 / (1 + v)              Toksvig eq. 2; exact for small v
///   Blinn-Phong exponent s = 1 / v    so length = s / (s + 1)
///   Beckmann and GGX alpha² = 2 v     Walter et al. 2007: s = 2 / alpha² - 2
/// Normals spread like a von Mises-Fisher lobe of concentration κ have length coth κ - 1/κ, which
/// for large κ is the same with v = 1/κ.
float slope_variance_of(float ndf_length);

/// 0 for no variance and below gives 1; never 0 or negative.
float ndf_length_of(float slope_variance);

/// Exponent of the Blinn-Phong lobe; infinite at length 1.
float blinn_phong_of(float ndf_length);

/// GGX roughness alpha, 0..1: 0 at length 1, at most 1.
float ggx_alpha_of(float ndf_length);

/// Length of the mean of `normals` ([n] unit) weighted by `areas` ([n] m², > 0). Empty: 1.
float mean_normal_length(std::span<const Vec3f> normals, std::span<const float> areas);

/// NDF lengths ([n], (0, 1]) of every point: the spread of the normals over its footprint (itself
/// and its neighbours of `table`), without what the range noise makes of it. Neighbours that face
/// away are of another surface. 1 where there is no normal. In parallel.
std::vector<float> estimate_ndf_lengths(const SurfacePoints& points, const NeighbourTable& table,
                                        const std::vector<LocalPlane>& planes, float range_noise);

}  // namespace glowworm

#pragma once

#include "octree/scene.h"

namespace glowworm {

/// Lumens in a watt of light whose channels are equal: what Radiance assumes of white light (Ward,
/// Rendering with Radiance, 1998). Lamps' and meters' photometric numbers are 179 times the
/// luminance of their radiometric ones.
inline constexpr double kLuminousEfficacy = 179.0;  // lm/W

/// Rec.709's share of each channel in what the eye takes for brightness.
double luminance_of(const Vec3f& rgb);

/// The light of a black body at `kelvin` (1667..25000, clamped) in linear Rec.709, luminance 1, no
/// channel negative. The Planckian locus as Kim et al. (US patent 7024034, 2002) fit it.
Vec3f color_of_temperature(double kelvin);

/// Watts (luminance-weighted over the channels) that leave a lamp.
double power_of(const PointLight& light);  ///< 4 pi I
double power_of(const SpotLight& light);   ///< I over the cone's falloff
double power_of(const AreaLight& light);   ///< pi A L, Lambert's emitter

/// Power of a spot over its intensity on the axis, sr: the integral over the cone of
/// cos(theta) smoothstep. cone_deg in (0, 180], blend in [0, 1].
double spot_solid_angle(double cone_deg, double blend);

/// m².
double area_of(const AreaLight& light);

}  // namespace glowworm

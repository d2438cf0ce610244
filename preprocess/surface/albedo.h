#pragma once

#include <cstdint>
#include <vector>

#include "octree/vec3.h"
#include "preprocess/points.h"
#include "preprocess/surface/surface.h"

namespace glowworm {

/// The linear value, 0..1, of an sRGB byte (IEC 61966-2-1).
float srgb_to_linear(std::uint8_t byte);

/// The byte whose linear value is nearest; clamped to 0..1, NaN is 0. Undoes srgb_to_linear
/// exactly.
std::uint8_t linear_to_srgb(float linear);

Vec3f to_linear(const Rgb8& colour);
Rgb8 to_srgb(const Vec3f& linear);

/// A column of albedo as sRGB bytes for `points` and where it came from: their colours; else their
/// intensities as grey, scaled so that the median is `default_albedo` (linear, 0..1) and kept
/// within 2..95 %; else `default_albedo` for all.
std::vector<Rgb8> albedo_bytes(const Points& points, float default_albedo, AlbedoSource& source);

}  // namespace glowworm

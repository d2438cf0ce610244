#pragma once

#include <cstdint>

#include "octree/surfel.h"
#include "preprocess/points.h"

namespace glowworm {

/// What was missing in a cloud that became surfels, for the log.
struct SurfelDefaults {
    bool ndf_missing = false;     ///< 1 was taken
    bool radius_missing = false;  ///< taken from the spacing
    bool colour_missing = false;  ///< the default albedo was taken
    std::uint64_t dropped = 0;    ///< points left out: no finite position or no normal
};

/// Surfels as the columns of a surfel PLY: albedo as sRGB bytes, emission only where a surfel
/// emits. Lossless where the albedo is one of the 256 linear values of sRGB bytes, as make_surfels'
/// are.
PointCloud to_points(const SurfelCloud& cloud);

/// The surfel of point `i` of a cloud with normals, whose length becomes 1; a normal that has none
/// stays zero. A radius that is no positive number becomes 0.
Surfel to_surfel(const Points& points, std::size_t i, float radius, const Rgb8& albedo);

/// The way back, from any cloud with positions and normals: a missing ndf is 1, a missing radius
/// comes from the spacing, missing colour is `default_albedo` (linear, 0..1), missing stations are
/// station 0. Normals are made unit; points with a zero or non-finite position or normal are left
/// out. Throws Error kDegenerate without normals and where nothing is left. `defaults` may be null.
SurfelCloud to_surfels(const PointCloud& cloud, float default_albedo = 0.5f,
                       SurfelDefaults* defaults = nullptr);

}  // namespace glowworm

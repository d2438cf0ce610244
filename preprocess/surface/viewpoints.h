#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/surface/normals.h"
#include "preprocess/surface/trajectory.h"

namespace glowworm {

/// Gives points that no station is known for the pose that `trajectory` (with times) has nearest to
/// their own time ([n] s, in the order of the cloud). Times outside the trajectory by more than a
/// second give none. Returns how many points got one.
std::size_t view_by_time(const Trajectory& trajectory, const Vec3d& origin,
                         std::span<const double> times, SurfacePoints& points);

/// Gives points that no station is known for the nearest pose that sees them: no disc of the cloud
/// stands between. Returns how many points got one. In parallel.
std::size_t view_by_sight(const Trajectory& trajectory, const Vec3d& origin,
                          const std::vector<LocalPlane>& planes, SurfacePoints& points);

/// Whether nearly every point sees the place `viewpoint`, m, relative to the cloud's origin, and
/// most from farther than a scanner's own size: then it is where the scanner stood. Asks a sample.
bool is_seen_by_all(const SurfacePoints& points, const std::vector<LocalPlane>& planes,
                    const Vec3f& viewpoint);

}  // namespace glowworm

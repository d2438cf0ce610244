#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/scan.h"

namespace glowworm {

/// A scan where it belongs.
struct PlacedView {
    const Scan* scan;
    Eigen::Isometry3d T_world_scan;  ///< maps the scan's positions to a frame common to all
};

/// Per scan the indices, ascending, of its points that no other station contradicts. A point is
/// moving when at least one other station looked through its place and saw a surface behind, and
/// no other station saw a surface there. Scans without a viewpoint have no vote. Points that are
/// not finite are left out.
std::vector<std::vector<std::uint32_t>> standing_points(std::span<const PlacedView> views);

}  // namespace glowworm

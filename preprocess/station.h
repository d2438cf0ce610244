#pragma once

#include "preprocess/points.h"

namespace glowworm {

/// Share of the points that lie far behind another point in the same direction from the origin,
/// 0..1, among points that share their direction with another. Directions are cells of `cell_deg`
/// degrees; "far" is more than ten cell widths at that depth, more than a surface at 84° of
/// incidence spans.
struct HiddenShare {
    double share = 0;        ///< 0..1; 0 where no two points share a cell
    std::size_t points = 0;  ///< how many share a cell
};
HiddenShare hidden_share(const Points& points, double cell_deg);

/// Above this share the points were seen from more than one place. Measured: single stations 0.004
/// (cave) to 0.10 (trees and poles); an object in its own frame 0.30 and more, a SLAM map 0.64.
inline constexpr double kHiddenShareLimit = 0.18;

/// Whether the frame's origin is the one place from which all points were seen: (almost) nothing
/// lies behind anything else. Not so for a SLAM map, a merged cloud or an object in its own frame.
/// Decided from the positions; false where too few points share a direction to tell.
bool origin_is_viewpoint(const Points& points);

}  // namespace glowworm

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
/// Below this share the origin is as good as the scanner's place: within 0.3 m in a cave.
inline constexpr double kSurelySeen = 0.02;
/// Between the two the share must rise to this factor a fifth of the median range to every side.
/// Measured: at least 1.5 around stations outdoors, at most 0.98 around places 1.6 to 5 m from the
/// station in the same chamber.
inline constexpr double kMoreAside = 1.2;

/// Whether the frame's origin is the one place from which all points were seen: (almost) nothing
/// lies behind anything else. Not so for a SLAM map, a merged cloud or an object in its own frame.
/// Decided from the positions; false where too few points share a direction to tell.
bool origin_is_viewpoint(const Points& points);

}  // namespace glowworm

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "preprocess/surface/normals.h"

namespace glowworm {

/// What decided on the side of points that no station saw and that no neighbour of theirs reaches.
enum class FreeSideRule : std::uint8_t {
    kClosedSide,  ///< the side from which rays end on surface: the passage's
    kOpenSide,    ///< the other one, for the closed side is too narrow for a scanner
    kUnclear,     ///< neither side is the more open one: upward
};

struct OrientationReport {
    std::size_t toward_stations = 0;       ///< points turned to the station that saw them
    std::size_t propagated = 0;            ///< points without one, turned as their neighbours are
    std::array<std::size_t, 3> by_rule{};  ///< of those, no station near: points by FreeSideRule
    std::size_t unsure = 0;                ///< points whose side nothing decided clearly

    std::size_t of(FreeSideRule rule) const { return by_rule[static_cast<std::size_t>(rule)]; }
};

/// Turns the normals of `planes` to the free side.
/// Points whose station is known face it; where it looked so flatly along the surface that the
/// normal's error decides, the neighbours vote. Points without a station are turned as their
/// neighbours are (normal_patches.h), and as the surfaces are that they see or are seen from
/// (free_side.h), starting from points with a station where any are joined to them. A component
/// that no station saw faces the side on which rays end on surface: a passage's inside; a thing too
/// small to have been scanned from within faces outward. `noise`, m, is the points' range noise.
OrientationReport orient_normals(const SurfacePoints& points, const NeighbourTable& table,
                                 float noise, std::vector<LocalPlane>& planes);

}  // namespace glowworm

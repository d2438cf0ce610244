#pragma once

#include <cstddef>
#include <vector>

#include "preprocess/surface/normals.h"

namespace glowworm {

struct OrientationReport {
    std::size_t toward_stations = 0;  ///< points turned to the station that saw them
    std::size_t propagated = 0;       ///< points without one, turned as their neighbours are
    std::size_t unsure = 0;           ///< points whose side nothing decided clearly
};

/// Turns the normals of `planes` to the free side.
/// Points whose station is known face it; where it looked so flatly along the surface that the
/// normal's error decides, the neighbours vote. Points without a station are turned as their
/// neighbours are, most parallel first (the minimal spanning tree of Hoppe et al. 1992 over the
/// table's neighbours, by union-find with parity), starting from points with a station where the
/// tree reaches one; a tree that reaches none faces the side from which surface is seen: rays
/// through the coarse occupancy of the cloud end on rock on the passage's side and run out behind.
OrientationReport orient_normals(const SurfacePoints& points, const NeighbourTable& table,
                                 float spacing, std::vector<LocalPlane>& planes);

}  // namespace glowworm

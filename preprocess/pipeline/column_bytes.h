#pragma once

#include "preprocess/points.h"

namespace glowworm {

/// Bytes of a point's columns; 0 where there are no points.
inline double bytes_of(const Points& points) {
    const auto column = [](const auto& values) {
        return values.empty() ? 0.0 : static_cast<double>(sizeof(values[0]));
    };
    return column(points.positions) + column(points.normals) + column(points.colours) +
           column(points.intensities) + column(points.ndf_lengths) + column(points.radii) +
           column(points.stations) + column(points.emissions) + column(points.times) +
           column(points.grid);
}

}  // namespace glowworm

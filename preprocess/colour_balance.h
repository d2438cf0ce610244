#pragma once

#include <cstddef>
#include <vector>

#include "preprocess/points.h"

namespace glowworm {

/// Gains per station and linear channel that make colours agree where stations overlap: least
/// squares of the differences of log colour between stations that share a cell of edge `cell`
/// metres, with a Huber loss, the mean log gain held at 0. 0.5..2. All 1 for points without colours
/// or stations, or where nothing overlaps.
std::vector<Vec3d> colour_gains(const Points& points, std::size_t stations, double cell);

/// Multiplies each point's linear colour by its station's gain; clipped at white.
void apply_gains(Points& points, const std::vector<Vec3d>& gains);

}  // namespace glowworm

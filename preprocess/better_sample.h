#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/points.h"

namespace glowworm {

/// Indices, ascending, of one point per occupied cell of edge `spacing` metres: the one that was
/// measured best. A sample costs its range (the spot and the angular noise grow with it) over the
/// cosine of incidence, at least 0.1; the normal is the point's own or that of the plane through
/// the points around it. `stations`: scanner places in the points' frame, by Points::stations; a
/// point whose station has no viewpoint costs as if seen from `far` metres. Throws Error kUsage
/// where the cloud spans more than 2²¹ cells. Empty in, empty out.
std::vector<std::uint32_t> best_samples(const Points& points, double spacing,
                                        std::span<const Vec3f> stations,
                                        std::span<const std::uint8_t> has_viewpoint,
                                        float far = 100.0f);

}  // namespace glowworm

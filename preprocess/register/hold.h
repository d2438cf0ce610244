#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/poses.h"
#include "preprocess/register/pairwise.h"

namespace glowworm {

/// Per scan the motions in which no accepted pair holds it to the `ground`, axes in the frame of
/// `poses` (T_frame_scan). Scans that hold each other in every direction move as one, so that a
/// single weak link between two firm groups makes all of the farther group loose. A scan of the
/// ground (the reference, scans whose pose is given) gets what its own pairs leave open: it is
/// information only, for something else holds it. Scans without accepted pairs have none.
std::vector<std::vector<WeakAxis>> loose_axes(std::span<const PairFit> pairs,
                                              std::span<const Eigen::Isometry3d> poses,
                                              std::span<const std::uint8_t> ground);

/// Which of `scans` scans lie on or between loops of accepted pairs: only there a misclosure says
/// anything.
std::vector<std::uint8_t> scans_in_loops(std::span<const PairFit> pairs, std::size_t scans);

}  // namespace glowworm

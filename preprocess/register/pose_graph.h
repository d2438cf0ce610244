#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/register/refine.h"

namespace glowworm {

/// A measured relative pose between two scans.
struct PoseEdge {
    std::size_t source = 0, target = 0;  ///< indices of scans
    Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
    Matrix6d covariance = Matrix6d::Identity();  ///< of a turn (rad) about `centre` and a shift (m)
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of what was seen in common, target frame
    double extent = 1.0;                               ///< m, rms size of what was seen in common
};

/// The covariance of a fit: residual variance over the information, with a floor of
/// `floor` metres (what even sampling and smoothing leave) on each direction.
PoseEdge make_edge(std::size_t source, std::size_t target, const Fit& fit, double floor);

/// How far an edge is from closing under `poses`.
struct Misclosure {
    double shift = 0;   ///< m, at the middle of what was seen in common
    double turn = 0;    ///< radians
    double sigmas = 0;  ///< Mahalanobis distance / sqrt(6)
};
Misclosure misclosure(const PoseEdge& edge, std::span<const Eigen::Isometry3d> poses);

/// Moves `poses` (T_world_scan) to the least sum of squared misclosures with a Cauchy loss, those
/// with `fixed` staying where they are; with `upright` turns about Z only. Single-threaded and so
/// the same every time. Scans without edges stay.
void solve_pose_graph(std::vector<Eigen::Isometry3d>& poses, std::span<const PoseEdge> edges,
                      std::span<const std::uint8_t> fixed, bool upright);

}  // namespace glowworm

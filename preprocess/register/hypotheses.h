#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "preprocess/register/correspondences.h"

namespace glowworm {

struct HypothesisSettings {
    double tolerance = 0.1;          ///< m, > 0: how far right correspondences may miss
    bool upright = false;            ///< only a turn about Z and a shift are sought
    std::size_t max_seeds = 200;     ///< correspondences that a hypothesis is grown from
    std::size_t max_count = 10;      ///< hypotheses kept
    std::size_t fewest_inliers = 6;  ///< correspondences that have to agree, at least 3
};

/// A guess at how two scans lie, and how many correspondences agree with it.
struct Hypothesis {
    Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
    std::size_t inliers = 0;
};

/// Distinct guesses, best first. Two correspondences are compatible when the distance between
/// their keypoints and the angles of their normals are the same on both sides; a guess is grown
/// from a seed and those that share most compatible partners with it (second-order spatial
/// compatibility: Chen et al., SC2-PCR, CVPR 2022). Right ones among 95 % wrong ones agree with one
/// another, wrong ones do not. No random numbers: same input, same guesses. Memory and time are
/// bounded by the number of correspondences squared / 8 bytes. Empty in, empty out.
std::vector<Hypothesis> hypothesize(const Keypoints& source, const Keypoints& target,
                                    std::span<const Correspondence> matches,
                                    const HypothesisSettings& settings);

/// How many of the correspondences `T_target_source` brings within `tolerance` metres, their
/// normals alike.
std::size_t count_agreeing(const Keypoints& source, const Keypoints& target,
                           std::span<const Correspondence> matches,
                           const Eigen::Isometry3d& T_target_source, double tolerance);

/// The rigid motion that moves `source` onto `target` with least squares (Kabsch); with `upright`
/// a turn about Z and a shift. At least 3 points.
Eigen::Isometry3d fit_motion(std::span<const Vec3f> source, std::span<const Vec3f> target,
                             bool upright);

}  // namespace glowworm

#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "preprocess/register/correspondences.h"
#include "preprocess/register/scan_model.h"

namespace glowworm {

struct GuessSettings {
    double voxel_size = 0.1;        ///< m, of the models' coarse samples
    bool upright = false;           ///< only a turn about Z and a shift are sought
    std::size_t max_grown = 200;    ///< guesses from many correspondences that are looked at
    std::size_t max_levelled = 60;  ///< guesses from single ones that are looked at twice
    std::size_t max_count = 8;      ///< guesses kept
};

/// A rough pose and what the two scans say to it at a glance.
struct Guess {
    Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
    double support = 0;  ///< as Agreement::support
};

/// Rough poses that the two scans speak for at a glance, best first: grown from
/// correspondences that agree with one another (see hypotheses.h), and led to by single ones under
/// the assumption that both scanners stood level. Narrow passages seen by sparse scans have but a
/// handful of right correspondences, too few to be seen as a group; and the cost of looking at many
/// wrong guesses is small. Empty in, empty out.
std::vector<Guess> guess_poses(const ScanModel& source, const ScanModel& target,
                               std::span<const Correspondence> matches,
                               const GuessSettings& settings);

}  // namespace glowworm

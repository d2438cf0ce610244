#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "octree/progress.h"
#include "preprocess/poses.h"
#include "preprocess/scan.h"

namespace glowworm {

struct MergeSettings {
    double spacing = 0.0;       ///< m, even spacing of the result; 0: the scans' own median spacing
    bool thin_overlaps = true;  ///< keep only the better sample where scans overlap
    bool remove_moving = true;  ///< free-space voting against people and tripods
    bool balance_colour = false;  ///< gains per scan so that overlaps agree in colour
};

struct MergeReport {
    std::uint64_t points_in = 0;
    std::uint64_t moving = 0;           ///< removed: contradicted by another station
    std::uint64_t thinned = 0;          ///< removed: a better sample of the same place is kept
    std::vector<std::string> left_out;  ///< scans without a pose, not merged
    double spacing = 0;                 ///< m, used
};

/// All scans with a pose (reference, registered or prior) in the world frame, each point with its
/// station. The result's origin is that of `poses`, moved to the scans where they lie more than
/// 1 km from it. Throws Error kDegenerate where no scan has a pose or no point is left.
PointCloud merge_scans(std::span<const Scan> scans, const Poses& poses,
                       const MergeSettings& settings, const Progress& progress = {},
                       MergeReport* report = nullptr);

}  // namespace glowworm

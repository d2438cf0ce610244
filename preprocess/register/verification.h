#pragma once

#include <Eigen/Geometry>
#include <cstddef>

#include "preprocess/register/scan_model.h"

namespace glowworm {

/// What the two scans of a pair say about a relative pose.
struct Agreement {
    std::size_t source_samples = 0, source_agree = 0, source_contradict = 0;
    std::size_t target_samples = 0, target_agree = 0, target_contradict = 0;

    /// Share of the source's surface that the target saw as well, 0..1.
    double overlap() const;
    /// The greater of that and the same the other way round.
    double best_overlap() const;
    /// Share of the samples with an opinion that are seen through by the other station, 0..1.
    double contradicted() const;
    std::size_t agree() const { return source_agree + target_agree; }
    /// What poses are ranked by: the overlap, one sample that is seen through outweighing 8 that
    /// agree.
    double support() const;
};

/// Compares up to `max_samples` coarse samples of each scan with the other. One agrees when the
/// other has a surface within `tolerance` metres that faces the same way; it contradicts when the
/// other station looked through its place, nearer by more than `tolerance` and 2 % of the range.
/// Scans without a viewpoint contradict nothing.
Agreement verify(const ScanModel& source, const ScanModel& target,
                 const Eigen::Isometry3d& T_target_source, double tolerance,
                 std::size_t max_samples = 1500);

}  // namespace glowworm

#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "preprocess/register/pose_graph.h"
#include "preprocess/register/refine.h"
#include "preprocess/register/scan_model.h"
#include "preprocess/register/verification.h"

namespace glowworm {

/// What is known of how two scans lie.
struct PairFit {
    std::size_t source = 0, target = 0;  ///< indices of scans
    Fit fit;
    Agreement agreement;
    std::size_t matches = 0;  ///< correspondences that agree with it; 0 where a pose was given
    bool ambiguous = false;   ///< another pose, elsewhere, could be believed too
    bool believed = false;    ///< by the evidence of the pair alone
    bool accepted = false;    ///< believed, and the other scans do not disagree
};

struct PairSettings {
    double voxel_size = 0.1;  ///< m, of the models' coarse samples
    bool upright = false;
};

/// Refines from `start` on the coarse samples, then on the fine ones, and asks both scans.
PairFit align_from(const ScanModel& source, const ScanModel& target, const Eigen::Isometry3d& start,
                   const PairSettings& settings);

/// The pair as it stands at `pose`: nothing is moved.
PairFit judge(const ScanModel& source, const ScanModel& target, const Eigen::Isometry3d& pose,
              const PairSettings& settings);

/// The best supported pose of a pair from nothing: descriptors matched, guesses made and looked at
/// (see guesses.h), the best of them refined and verified, the winner refined finely. Not believed
/// where there is none, nor where a second pose that lies elsewhere could be believed as well, as
/// in a passage that repeats itself: such poses are looked for among the guesses and by sliding the
/// winner along the passage; unless the winner has weak axes, which say it already.
PairFit align_pair(const ScanModel& source, const ScanModel& target, const PairSettings& settings);

/// Whether the evidence of the pair alone speaks for it: enough surface in common, (almost) none
/// of it seen through, residuals of the size of the sampling.
bool believable(const PairFit& pair, const PairSettings& settings, bool has_free_space);

}  // namespace glowworm

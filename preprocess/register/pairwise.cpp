#include "preprocess/register/pairwise.h"

#include <algorithm>

#include "preprocess/register/correspondences.h"
#include "preprocess/register/guesses.h"
#include "preprocess/register/hypotheses.h"
#include "preprocess/register/rivals.h"
#include "preprocess/register/trust.h"

namespace glowworm {
namespace {

// Measured on the simulated cave and a real site: right poses are contradicted by at most 0.006 of
// the samples with an opinion, wrong ones by at least 0.076.
constexpr double kMostContradicted = 0.025;
constexpr double kLeastOverlap = 0.08;
constexpr std::size_t kLeastInliers = 200;
// Sparse scans have few samples where they meet. That many within half a voxel whose residuals are
// a tenth of that did not come there by chance.
constexpr std::size_t kLeastExactInliers = 50;
constexpr double kVeryExactRmse = 0.04;  // in voxel sizes
// Without free space only the fit itself can speak, so more of it is asked for.
constexpr double kLeastOverlapAlone = 0.30;
constexpr std::size_t kLeastMatchesAlone = 12;
constexpr std::size_t kNearest = 3;  // descriptors that may be each other's match
constexpr std::size_t kFinalists = 3;
constexpr double kWorstRmse = 0.20;  // in voxel sizes
// Right poses leave residuals as small as this or as the scans' own noise lets expect (1.1 to 1.7
// times that, measured); mirror images that look nearly alike leave more, and so do scanners that
// moved, for which many keypoints must speak.
constexpr double kExactRmse = 0.07;  // in voxel sizes
constexpr double kNoiseRmse = 3.0;   // in what the samples' variances let expect
constexpr std::size_t kManyMatches = 150;
// Of the winner's support: a believable pose elsewhere with that much is a rival. A passage that
// repeats itself supports the least shift best, because then most is seen in common.
constexpr double kRival = 0.4;
constexpr double kElsewhere = 3.0;  // voxel sizes, at the middle of what is seen in common

bool elsewhere(const Eigen::Isometry3d& T, const Fit& fit, double voxel_size) {
    const Eigen::Isometry3d gap = T * fit.T_target_source.inverse();
    const double shift = (gap * fit.centre - fit.centre).norm();
    const double turn = Eigen::AngleAxisd(gap.rotation()).angle() * fit.extent;
    return shift + turn > kElsewhere * voxel_size;
}

RefineSettings coarse_settings(const PairSettings& s, std::size_t samples) {
    return {.gate = 3.0 * s.voxel_size,
            .final_gate = 1.5 * s.voxel_size,
            .upright = s.upright,
            .max_samples = samples,
            .max_iterations = 20};
}

void refine_finely(const ScanModel& source, const ScanModel& target, const Eigen::Isometry3d& start,
                   const PairSettings& s, PairFit& pair) {
    pair.fit =
        refine(source.fine, target.fine, start,
               {.gate = s.voxel_size, .final_gate = 0.5 * s.voxel_size, .upright = s.upright});
    pair.agreement = verify(source, target, pair.fit.T_target_source, s.voxel_size);
    pair.believed = believable(pair, s, source.depths.has_value() || target.depths.has_value());
}

}  // namespace

bool believable(const PairFit& pair, const PairSettings& settings, bool has_free_space) {
    const bool given = pair.matches == 0;
    const bool very_exact = pair.fit.rmse <= kVeryExactRmse * settings.voxel_size;
    if (pair.fit.inliers < (very_exact ? kLeastExactInliers : kLeastInliers)) return false;
    if (pair.fit.rmse > kWorstRmse * settings.voxel_size) return false;
    if (pair.agreement.contradicted() > kMostContradicted) return false;
    if (pair.agreement.best_overlap() < kLeastOverlap) return false;
    const bool exact =
        pair.fit.rmse <= std::max(kExactRmse * settings.voxel_size, kNoiseRmse * pair.fit.expected);
    if (!given && !exact && pair.matches < kManyMatches) return false;
    return has_free_space || given ||
           (pair.agreement.best_overlap() >= kLeastOverlapAlone &&
            pair.matches >= kLeastMatchesAlone);
}

PairFit align_from(const ScanModel& source, const ScanModel& target, const Eigen::Isometry3d& start,
                   const PairSettings& settings) {
    PairFit pair;
    const Fit coarse = refine(source.coarse, target.coarse, start, coarse_settings(settings, 4000));
    refine_finely(source, target, coarse.T_target_source, settings, pair);
    return pair;
}

PairFit judge(const ScanModel& source, const ScanModel& target, const Eigen::Isometry3d& pose,
              const PairSettings& s) {
    PairFit pair;
    pair.fit = refine(source.fine, target.fine, pose,
                      {.gate = 0.5 * s.voxel_size,
                       .final_gate = 0.5 * s.voxel_size,
                       .upright = s.upright,
                       .max_iterations = 1});
    pair.fit.T_target_source = pose;
    pair.agreement = verify(source, target, pose, s.voxel_size);
    pair.believed = believable(pair, s, source.depths.has_value() || target.depths.has_value());
    return pair;
}

PairFit align_pair(const ScanModel& source, const ScanModel& target, const PairSettings& settings) {
    // 1. Correspondences and guesses.
    const std::vector<Correspondence> matches = match(source.keypoints, target.keypoints, kNearest);
    const std::vector<Guess> guesses = guess_poses(
        source, target, matches, {.voxel_size = settings.voxel_size, .upright = settings.upright});

    // 2. Each guess refined on few samples, and both scans asked.
    struct Tried {
        Eigen::Isometry3d T;
        double support;
    };
    std::vector<Tried> tried;
    for (const Guess& guess : guesses) {
        const Fit fit = refine(source.coarse, target.coarse, guess.T_target_source,
                               coarse_settings(settings, 1500));
        const Agreement agreement =
            verify(source, target, fit.T_target_source, settings.voxel_size, 800);
        tried.push_back({fit.T_target_source, agreement.support()});
    }
    std::stable_sort(tried.begin(), tried.end(),
                     [](const Tried& a, const Tried& b) { return a.support > b.support; });

    // 3. The best supported ones refined finely, until one is believed.
    PairFit best;
    for (std::size_t i = 0; i < std::min(tried.size(), kFinalists); ++i) {
        PairFit pair;
        pair.matches =
            std::max<std::size_t>(1, count_agreeing(source.keypoints, target.keypoints, matches,
                                                    tried[i].T, 2.0 * settings.voxel_size));
        refine_finely(source, target, tried[i].T, settings, pair);
        if (i == 0 || pair.agreement.support() > best.agreement.support()) best = pair;
        if (best.believed) break;
    }
    if (!best.believed || !weak_axes(best.fit).empty()) return best;

    // 4. Any other place that fits nearly as well, led to by keypoints or not?
    const double least = kRival * best.agreement.support();
    const auto rivals = [&](const Eigen::Isometry3d& T) {
        if (!elsewhere(T, best.fit, settings.voxel_size)) return false;
        PairFit rival;
        rival.matches = best.matches;
        refine_finely(source, target, T, settings, rival);
        return rival.believed && rival.agreement.support() >= least &&
               elsewhere(rival.fit.T_target_source, best.fit, settings.voxel_size);
    };
    for (const Tried& other : tried) {
        if (other.support < least) break;
        best.ambiguous = best.ambiguous || rivals(other.T);
    }
    for (const Eigen::Isometry3d& start :
         slid_rivals(source, target, best.fit, settings.voxel_size)) {
        if (best.ambiguous) break;
        const Eigen::Isometry3d T =
            refine(source.coarse, target.coarse, start, coarse_settings(settings, 1500))
                .T_target_source;
        best.ambiguous =
            verify(source, target, T, settings.voxel_size, 800).support() >= least && rivals(T);
    }
    best.believed = !best.ambiguous;
    return best;
}

}  // namespace glowworm

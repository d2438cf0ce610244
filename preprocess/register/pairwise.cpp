#include "preprocess/register/pairwise.h"

#include <algorithm>

#include "preprocess/register/correspondences.h"
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
// Without free space only the fit itself can speak, so more of it is asked for.
constexpr double kLeastOverlapAlone = 0.30;
constexpr std::size_t kLeastMatchesAlone = 12;
constexpr std::size_t kFinalists = 3;
constexpr double kWorstRmse = 0.20;  // in voxel sizes; right ones lie below 0.08
constexpr double kAgainst = 8.0;     // how many agreeing samples one contradiction outweighs
// Of the winner's support: a believable pose elsewhere with that much is a rival. A passage that
// repeats itself supports the least shift best, because then most is seen in common.
constexpr double kRival = 0.4;
constexpr double kElsewhere = 3.0;  // voxel sizes, at the middle of what is seen in common

double support(const Agreement& agreement) {
    return agreement.best_overlap() - kAgainst * agreement.contradicted();
}

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
    if (pair.fit.inliers < kLeastInliers) return false;
    if (pair.fit.rmse > kWorstRmse * settings.voxel_size) return false;
    if (pair.agreement.contradicted() > kMostContradicted) return false;
    if (pair.agreement.best_overlap() < kLeastOverlap) return false;
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
    const std::vector<Correspondence> matches = match(source.keypoints, target.keypoints);
    const std::vector<Hypothesis> guesses =
        hypothesize(source.keypoints, target.keypoints, matches,
                    {.tolerance = 2.0 * settings.voxel_size, .upright = settings.upright});

    // 2. Each guess refined on few samples, and both scans asked.
    struct Tried {
        Eigen::Isometry3d T;
        std::size_t matches;
        double support;
    };
    std::vector<Tried> tried;
    for (const Hypothesis& guess : guesses) {
        const Fit fit = refine(source.coarse, target.coarse, guess.T_target_source,
                               coarse_settings(settings, 1500));
        const Agreement agreement =
            verify(source, target, fit.T_target_source, settings.voxel_size, 800);
        tried.push_back({fit.T_target_source, guess.inliers, support(agreement)});
    }
    std::stable_sort(tried.begin(), tried.end(),
                     [](const Tried& a, const Tried& b) { return a.support > b.support; });

    // 3. The best supported ones refined finely, until one is believed.
    PairFit best;
    for (std::size_t i = 0; i < std::min(tried.size(), kFinalists); ++i) {
        PairFit pair;
        pair.matches = tried[i].matches;
        refine_finely(source, target, tried[i].T, settings, pair);
        if (i == 0 || support(pair.agreement) > support(best.agreement)) best = pair;
        if (best.believed) break;
    }
    if (!best.believed || !weak_axes(best.fit).empty()) return best;

    // 4. Any other place that fits nearly as well, led to by keypoints or not?
    const double least = kRival * support(best.agreement);
    const auto rivals = [&](const Eigen::Isometry3d& T) {
        if (!elsewhere(T, best.fit, settings.voxel_size)) return false;
        PairFit rival;
        rival.matches = best.matches;
        refine_finely(source, target, T, settings, rival);
        return rival.believed && support(rival.agreement) >= least &&
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
            support(verify(source, target, T, settings.voxel_size, 800)) >= least && rivals(T);
    }
    best.believed = !best.ambiguous;
    return best;
}

}  // namespace glowworm

#include "preprocess/register/guesses.h"

#include <algorithm>
#include <cmath>

#include "preprocess/register/hypotheses.h"
#include "preprocess/register/verification.h"

namespace glowworm {
namespace {

constexpr std::size_t kFewestInliers = 4;  // of a grown guess: the scans are asked about each
constexpr double kGlanceTolerance = 2.0;   // voxel sizes: guesses are rough
constexpr std::size_t kGlanceSamples = 300;
// Single correspondences make many guesses: they are thinned by a shorter glance first.
constexpr std::size_t kShortGlanceSamples = 60;
constexpr double kLevelTolerance = 0.25;  // of the normals' vertical parts
constexpr double kSteepest = 0.95;        // vertical part: a floor's normal says nothing of yaw

/// The best supported `count` of `poses`, best first.
std::vector<Guess> best_at_a_glance(const ScanModel& source, const ScanModel& target,
                                    std::span<const Eigen::Isometry3d> poses, double voxel_size,
                                    std::size_t samples, std::size_t count) {
    std::vector<Guess> guesses;
    for (const Eigen::Isometry3d& T : poses) {
        guesses.push_back(
            {T, verify(source, target, T, kGlanceTolerance * voxel_size, samples).support()});
    }
    std::stable_sort(guesses.begin(), guesses.end(),
                     [](const Guess& a, const Guess& b) { return a.support > b.support; });
    guesses.resize(std::min(guesses.size(), count));
    return guesses;
}

/// What each correspondence says of two scanners that stood level: its normals give the turn about
/// the vertical, its places the shift.
std::vector<Eigen::Isometry3d> levelled_guesses(const ScanModel& source, const ScanModel& target,
                                                std::span<const Correspondence> matches) {
    const Eigen::Matrix3d& R_source = source.R_model_scan;
    const Eigen::Matrix3d& R_target = target.R_model_scan;
    std::vector<Eigen::Isometry3d> poses;
    for (const Correspondence& match : matches) {
        const Eigen::Vector3d n =
            R_source.transpose() * to_eigen(source.keypoints.normals[match.source]).cast<double>();
        const Eigen::Vector3d m =
            R_target.transpose() * to_eigen(target.keypoints.normals[match.target]).cast<double>();
        if (std::abs(n.z() - m.z()) > kLevelTolerance || std::abs(n.z()) > kSteepest) continue;
        const double yaw = std::atan2(m.y(), m.x()) - std::atan2(n.y(), n.x());
        Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
        T.linear() =
            R_target * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * R_source.transpose();
        T.translation() =
            to_eigen(target.keypoints.positions[match.target]).cast<double>() -
            T.linear() * to_eigen(source.keypoints.positions[match.source]).cast<double>();
        poses.push_back(T);
    }
    return poses;
}

}  // namespace

std::vector<Guess> guess_poses(const ScanModel& source, const ScanModel& target,
                               std::span<const Correspondence> matches,
                               const GuessSettings& settings) {
    std::vector<Eigen::Isometry3d> poses;
    for (const Guess& levelled :
         best_at_a_glance(source, target, levelled_guesses(source, target, matches),
                          settings.voxel_size, kShortGlanceSamples, settings.max_levelled)) {
        poses.push_back(levelled.T_target_source);
    }
    for (const Hypothesis& grown : hypothesize(source.keypoints, target.keypoints, matches,
                                               {.tolerance = 2.0 * source.wide.spacing,
                                               .upright = settings.upright,
                                               .max_seeds = 3 * settings.max_grown,
                                               .max_count = settings.max_grown,
                                               .fewest_inliers = kFewestInliers})) {
        poses.push_back(grown.T_target_source);
    }
    return best_at_a_glance(source, target, poses, settings.voxel_size, kGlanceSamples,
                            settings.max_count);
}

}  // namespace glowworm

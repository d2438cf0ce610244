#include "preprocess/register/frames.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace glowworm {
namespace {

constexpr double kNearOrigin = 1000.0;  // m
constexpr double kLeastOverlap = 0.05;

Eigen::Vector3d as_eigen(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

bool pair_wanted(const RegistrationSettings& settings, std::size_t a, std::size_t b) {
    if (settings.pairs.empty()) return true;
    return std::any_of(settings.pairs.begin(), settings.pairs.end(), [&](const auto& pair) {
        return std::minmax(pair.first, pair.second) == std::minmax(a, b);
    });
}

}  // namespace

Eigen::Isometry3d given_pose(std::span<const ScanModel> models, const LocalFrame& frame,
                             std::size_t i) {
    return *frame.given[i] *
           Eigen::Isometry3d(Eigen::Quaterniond(models[i].R_model_scan.transpose()));
}

LocalFrame choose_frame(std::span<const Scan> scans, const RegistrationSettings& settings) {
    LocalFrame frame;
    frame.given.resize(scans.size());
    frame.fixed.assign(scans.size(), 0);
    if (settings.mode == PriorMode::kIgnore) return frame;

    // Given poses in the world, then the world moved near to the first of them.
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const Eigen::Translation3d offset(as_eigen(scans[i].offset));
        if (settings.prior) {
            const ScanPose* pose = find_pose(*settings.prior, scans[i]);
            if (pose != nullptr && pose->status != PoseStatus::kUnregistered) {
                frame.given[i] = Eigen::Translation3d(as_eigen(settings.prior->origin)) *
                                 pose->T_world_scan * offset;
            }
        }
        if (!frame.given[i] && scans[i].T_world_scan)
            frame.given[i] = *scans[i].T_world_scan * offset;
    }
    const auto first = std::find_if(frame.given.begin(), frame.given.end(),
                                    [](const auto& pose) { return pose.has_value(); });
    if (first == frame.given.end()) return frame;
    const Eigen::Vector3d place = (*first)->translation();
    if (place.norm() > kNearOrigin) {
        frame.origin = {std::round(place.x()), std::round(place.y()), std::round(place.z())};
    }
    for (std::size_t i = 0; i < scans.size(); ++i) {
        if (!frame.given[i]) continue;
        frame.given[i] = Eigen::Translation3d(-as_eigen(frame.origin)) * *frame.given[i];
        frame.fixed[i] = settings.mode == PriorMode::kTrust;
    }
    frame.all_given =
        std::all_of(frame.fixed.begin(), frame.fixed.end(), [](auto f) { return f != 0; });
    return frame;
}

Assembly start_assembly(std::span<const ScanModel> models, const LocalFrame& frame,
                        const RegistrationSettings& settings) {
    Assembly assembly = apart(frame.given.size());
    std::size_t trusted = frame.given.size();
    for (std::size_t i = 0; i < frame.given.size(); ++i) {
        if (!frame.given[i]) continue;
        assembly.poses[i] = given_pose(models, frame, i);
        if (settings.mode != PriorMode::kTrust) continue;
        trusted = std::min(trusted, i);
        assembly.group[i] = trusted;
    }
    return assembly;
}

std::vector<PairFit> given_pairs(std::span<const ScanModel> models, const LocalFrame& frame,
                                 const PairSettings& pair_settings,
                                 const RegistrationSettings& settings) {
    std::vector<PairFit> pairs;
    for (std::size_t target = 0; target < models.size(); ++target) {
        for (std::size_t source = target + 1; source < models.size(); ++source) {
            if (!frame.given[target] || !frame.given[source]) continue;
            if (!pair_wanted(settings, target, source)) continue;
            PairFit pair;
            pair.source = source;
            pair.target = target;
            pairs.push_back(pair);
        }
    }
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
        PairFit& pair = pairs[i];
        const ScanModel &source = models[pair.source], &target = models[pair.target];
        const Eigen::Isometry3d start = given_pose(models, frame, pair.target).inverse() *
                                        given_pose(models, frame, pair.source);
        const Agreement near = verify(source, target, start, 3.0 * pair_settings.voxel_size, 500);
        if (near.best_overlap() < kLeastOverlap) return;
        const bool trusted = frame.fixed[pair.source] && frame.fixed[pair.target];
        PairFit aligned = trusted ? judge(source, target, start, pair_settings)
                                  : align_from(source, target, start, pair_settings);
        aligned.source = pair.source;
        aligned.target = pair.target;
        pair = aligned;
    });
    std::erase_if(pairs, [](const PairFit& pair) { return pair.fit.inliers == 0; });
    return pairs;
}

}  // namespace glowworm

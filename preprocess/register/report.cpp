#include "preprocess/register/report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "preprocess/register/hold.h"
#include "preprocess/register/trust.h"

namespace glowworm {
namespace {

constexpr double kDegrees = 57.29577951308232;
constexpr double kMuchBetter = 0.5;  // of the gap to the other given poses

Eigen::Vector3d as_eigen(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

/// The largest group's lowest index: the scan whose frame is the world's when none is given.
std::size_t main_group(const Assembly& assembly) {
    std::map<std::size_t, std::size_t> sizes;
    for (const std::size_t g : assembly.group)
        ++sizes[g];
    std::size_t best = 0, most = 0;
    for (const auto& [group, size] : sizes) {
        if (size > most) {
            best = group;
            most = size;
        }
    }
    return best;
}

/// Per group with given poses the scan whose pose places it: the one that the others' given poses
/// agree with best, the first where none is much better.
std::map<std::size_t, std::size_t> holders(std::span<const ScanModel> models,
                                           const LocalFrame& frame, const Assembly& assembly) {
    std::map<std::size_t, std::vector<std::size_t>> members;
    for (std::size_t i = 0; i < models.size(); ++i) {
        if (frame.given[i]) members[assembly.group[i]].push_back(i);
    }
    std::map<std::size_t, std::size_t> holder;
    for (const auto& [group, given] : members) {
        double best = std::numeric_limits<double>::infinity();
        for (const std::size_t i : given) {
            const Eigen::Isometry3d T = given_pose(models, frame, i) * assembly.poses[i].inverse();
            std::vector<double> gaps;
            for (const std::size_t j : given) {
                gaps.push_back((T * assembly.poses[j].translation() -
                                given_pose(models, frame, j).translation())
                                   .norm());
            }
            const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
            std::nth_element(gaps.begin(), middle, gaps.end());
            if (!(*middle < kMuchBetter * best)) continue;
            best = *middle;
            holder[group] = i;
        }
    }
    return holder;
}

/// Takes away the place of groups whose given poses put them into the free space of larger ones.
void drop_contradicted(std::span<const ScanModel> models, const LocalFrame& frame,
                       const Assembly& assembly, const PairSettings& settings,
                       const std::map<std::size_t, Eigen::Isometry3d>& T_local_group,
                       std::map<std::size_t, std::size_t>& holder) {
    std::vector<std::size_t> order;
    for (const auto& [group, scan] : holder)
        order.push_back(group);
    const auto size = [&](std::size_t g) {
        return std::count(assembly.group.begin(), assembly.group.end(), g);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
    std::vector<std::size_t> kept;
    for (const std::size_t g : order) {
        const bool free = std::all_of(kept.begin(), kept.end(), [&](std::size_t k) {
            return compatible(models, assembly, g, k,
                              T_local_group.at(k).inverse() * T_local_group.at(g),
                              settings.voxel_size);
        });
        if (free || frame.fixed[holder.at(g)]) {
            kept.push_back(g);
        } else {
            holder.erase(g);
        }
    }
}

}  // namespace

void write_report(std::span<const Scan> scans, std::span<const ScanModel> models,
                  std::span<const PairFit> pairs, const PairSettings& settings,
                  const LocalFrame& frame, const Assembly& assembly, Registration& result) {
    const std::size_t n = scans.size();
    const bool any_given = std::any_of(frame.given.begin(), frame.given.end(),
                                       [](const auto& pose) { return pose.has_value(); });
    const std::size_t main = main_group(assembly);
    Poses& poses = result.poses;
    poses.origin = any_given ? frame.origin : scans[main].offset;

    // Each group's motion into the local frame: by its given poses, else the main group's own.
    std::vector<Eigen::Isometry3d> T_model_scan;  // from positions
    for (const ScanModel& model : models) {
        T_model_scan.emplace_back(Eigen::Quaterniond(model.R_model_scan));
    }
    std::map<std::size_t, std::size_t> holder = holders(models, frame, assembly);
    if (!any_given) holder[main] = main;
    std::map<std::size_t, Eigen::Isometry3d> T_local_group;
    for (const auto& [g, i] : holder) {
        const Eigen::Isometry3d T_local_model =
            any_given ? given_pose(models, frame, i) : T_model_scan[i].inverse();
        T_local_group[g] = T_local_model * assembly.poses[i].inverse();
    }
    if (any_given) drop_contradicted(models, frame, assembly, settings, T_local_group, holder);
    const std::size_t reference = holder.contains(main) ? holder.at(main) : holder.begin()->second;

    std::vector<Eigen::Isometry3d> local(n, Eigen::Isometry3d::Identity());
    for (std::size_t i = 0; i < n; ++i) {
        ScanPose pose;
        pose.file = pose_file(scans[i]);
        const std::size_t g = assembly.group[i];
        if (holder.contains(g)) {
            local[i] = T_local_group[g] * assembly.poses[i];
            const bool alone = std::count(assembly.group.begin(), assembly.group.end(), g) == 1;
            pose.T_world_scan =
                local[i] * T_model_scan[i] * Eigen::Translation3d(-as_eigen(scans[i].offset));
            pose.status = i == reference && !frame.fixed[i]             ? PoseStatus::kReference
                          : frame.fixed[i] || (alone && frame.given[i]) ? PoseStatus::kPrior
                                                                        : PoseStatus::kRegistered;
        }
        result.unregistered += pose.status == PoseStatus::kUnregistered ? 1 : 0;
        poses.scans.push_back(pose);
    }

    const std::vector<std::uint8_t> in_loop = scans_in_loops(pairs, n);
    for (const PairFit& pair : pairs) {
        if (pair.fit.inliers == 0) continue;
        PairPose entry{.source = poses.scans[pair.source].file,
                       .target = poses.scans[pair.target].file,
                       .overlap = pair.agreement.overlap(),
                       .contradicted = pair.agreement.contradicted(),
                       .rmse = pair.fit.rmse,
                       .p95 = pair.fit.p95,
                       .inliers = pair.fit.inliers,
                       .accepted = pair.accepted,
                       .weak_axes = rotate(weak_axes(pair.fit), local[pair.target])};
        entry.T_target_source = Eigen::Translation3d(as_eigen(scans[pair.target].offset)) *
                                T_model_scan[pair.target].inverse() * pair.fit.T_target_source *
                                T_model_scan[pair.source] *
                                Eigen::Translation3d(-as_eigen(scans[pair.source].offset));
        poses.pairs.push_back(entry);
        if (!pair.accepted) continue;
        const Misclosure gap = misclosure(edge_of(pair, settings), assembly.poses);
        for (const std::size_t i : {pair.source, pair.target}) {
            ScanPose& pose = poses.scans[i];
            pose.rmse = std::max(pose.rmse, pair.fit.rmse);
            pose.overlap = std::max(pose.overlap, pair.agreement.best_overlap());
            if (!in_loop[i] || !in_loop[i == pair.source ? pair.target : pair.source]) continue;
            pose.loop_misclosure = std::max(pose.loop_misclosure.value_or(0.0), gap.shift);
            pose.loop_misclosure_deg =
                std::max(pose.loop_misclosure_deg.value_or(0.0), gap.turn * kDegrees);
        }
    }
    std::vector<std::uint8_t> given(n);
    for (std::size_t i = 0; i < n; ++i)
        given[i] = i == reference || frame.given[i].has_value();
    const std::vector<std::vector<WeakAxis>> loose = loose_axes(pairs, local, given);
    for (std::size_t i = 0; i < n; ++i) {
        if (poses.scans[i].status == PoseStatus::kUnregistered) continue;
        poses.scans[i].weak_axes = loose[i];
        if (!given[i] && !loose[i].empty()) result.loose.push_back(i);
    }
}

}  // namespace glowworm

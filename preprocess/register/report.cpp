#include "preprocess/register/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "preprocess/register/trust.h"

namespace glowworm {
namespace {

constexpr double kDegrees = 57.29577951308232;

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

/// Information about the pose of scan `i` from all its accepted pairs, in the world.
Fit joint_information(std::size_t i, std::span<const PairFit> pairs,
                      std::span<const Eigen::Isometry3d> poses) {
    Fit joint;
    double weight = 0.0;
    for (const bool summing : {false, true}) {
        for (const PairFit& pair : pairs) {
            if (!pair.accepted || (pair.source != i && pair.target != i)) continue;
            const Eigen::Isometry3d& T = poses[pair.target];
            const Eigen::Vector3d centre = T * pair.fit.centre;
            const double w = pair.fit.information.bottomRightCorner<3, 3>().trace();
            if (!summing) {
                joint.centre += w * centre;
                weight += w;
                continue;
            }
            // A turn about the joint centre shifts this pair's centre as well.
            Matrix6d A = Matrix6d::Identity();
            A.topLeftCorner<3, 3>() = T.rotation().transpose();
            A.bottomRightCorner<3, 3>() = T.rotation().transpose();
            const Eigen::Vector3d arm = centre - joint.centre;
            Eigen::Matrix3d cross;
            cross << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
            A.bottomLeftCorner<3, 3>() = T.rotation().transpose() * cross;
            joint.information += A.transpose() * pair.fit.information * A;
            joint.extent += w * (pair.fit.extent * pair.fit.extent + arm.squaredNorm());
        }
        if (weight <= 0.0) return joint;
        if (!summing) joint.centre /= weight;
    }
    joint.extent = std::sqrt(joint.extent / weight);
    return joint;
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

    // Each group's motion into the local frame: its first given pose, else the main group's own.
    std::vector<Eigen::Isometry3d> T_model_scan;  // from positions
    for (const ScanModel& model : models) {
        T_model_scan.emplace_back(Eigen::Quaterniond(model.R_model_scan));
    }
    std::map<std::size_t, Eigen::Isometry3d> T_local_group;
    std::map<std::size_t, std::size_t> holder;
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t g = assembly.group[i];
        if (holder.contains(g)) continue;
        if (frame.given[i]) {
            T_local_group[g] = given_pose(models, frame, i) * assembly.poses[i].inverse();
            holder[g] = i;
        } else if (!any_given && g == main && i == main) {
            T_local_group[g] = T_model_scan[i].inverse() * assembly.poses[i].inverse();
            holder[g] = i;
        }
    }
    const std::size_t reference =
        any_given && !holder.contains(main) ? holder.begin()->second : holder.at(main);

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
            pose.loop_misclosure = std::max(pose.loop_misclosure, gap.shift);
            pose.loop_misclosure_deg = std::max(pose.loop_misclosure_deg, gap.turn * kDegrees);
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        poses.scans[i].weak_axes = weak_axes(joint_information(i, pairs, local));
        result.weak += poses.scans[i].weak_axes.empty() ? 0 : 1;
    }
}

std::string trust_table(const Registration& registration) {
    const auto shortened = [](const std::string& file) {
        const std::size_t slash = file.rfind('/');
        return slash == std::string::npos ? file : file.substr(slash + 1);
    };
    const auto axes = [](const std::vector<WeakAxis>& weak) {
        std::string text;
        for (const WeakAxis& w : weak) {
            text += fmt::format("{}{} ({:.2f} {:.2f} {:.2f})", text.empty() ? "" : ", ",
                                w.rotation ? "turn about" : "shift along", w.axis.x, w.axis.y,
                                w.axis.z);
        }
        return text.empty() ? std::string("-") : text;
    };
    const Poses& poses = registration.poses;
    std::size_t width = 4;
    for (const ScanPose& pose : poses.scans)
        width = std::max(width, shortened(pose.file).size());

    std::string text = fmt::format("{:<{}}  {:<12} {:>7} {:>8} {:>12} {:>11}  weak axes\n", "scan",
                                   width, "status", "overlap", "rmse mm", "loop mm", "loop deg");
    for (const ScanPose& pose : poses.scans) {
        text += fmt::format("{:<{}}  {:<12} {:>6.0f}% {:>8.1f} {:>12.1f} {:>11.3f}  {}\n",
                            shortened(pose.file), width, to_string(pose.status),
                            100.0 * pose.overlap, 1000.0 * pose.rmse, 1000.0 * pose.loop_misclosure,
                            pose.loop_misclosure_deg, axes(pose.weak_axes));
    }
    text +=
        fmt::format("\n{:<{}}  {:<{}} {:>8} {:>8} {:>8} {:>8} {:>8}  weak axes\n", "source", width,
                    "target", width, "overlap", "through", "rmse mm", "p95 mm", "inliers");
    for (const PairPose& pair : poses.pairs) {
        if (!pair.accepted) continue;
        text += fmt::format("{:<{}}  {:<{}} {:>7.0f}% {:>7.1f}% {:>8.1f} {:>8.1f} {:>8}  {}\n",
                            shortened(pair.source), width, shortened(pair.target), width,
                            100.0 * pair.overlap, 100.0 * pair.contradicted, 1000.0 * pair.rmse,
                            1000.0 * pair.p95, pair.inliers, axes(pair.weak_axes));
    }
    return text;
}

}  // namespace glowworm

#include "preprocess/register/hold.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "preprocess/register/trust.h"

namespace glowworm {
namespace {

using PairList = std::vector<const PairFit*>;

/// What several pairs say together about one rigid motion of everything on one side of them. A
/// pair's information about its source's pose is the same as about its target's.
Fit joint_information(const PairList& pairs, std::span<const Eigen::Isometry3d> poses) {
    Fit joint;
    double weight = 0.0;
    for (const PairFit* pair : pairs) {
        const double w = pair->fit.information.bottomRightCorner<3, 3>().trace();
        joint.centre += w * (poses[pair->target] * pair->fit.centre);
        weight += w;
    }
    if (weight <= 0.0) return joint;
    joint.centre /= weight;
    for (const PairFit* pair : pairs) {
        const Eigen::Isometry3d& T = poses[pair->target];
        const Eigen::Vector3d arm = T * pair->fit.centre - joint.centre;
        // A turn about the joint centre shifts this pair's centre as well.
        Eigen::Matrix3d cross;
        cross << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
        const Eigen::Matrix3d R = T.rotation().transpose();
        Matrix6d A = Matrix6d::Zero();
        A.topLeftCorner<3, 3>() = R;
        A.bottomRightCorner<3, 3>() = R;
        A.bottomLeftCorner<3, 3>() = R * cross;
        joint.information += A.transpose() * pair->fit.information * A;
        const double w = pair->fit.information.bottomRightCorner<3, 3>().trace();
        joint.extent += w * (pair->fit.extent * pair->fit.extent + arm.squaredNorm());
    }
    joint.extent = std::sqrt(joint.extent / weight);
    return joint;
}

double weight_of(const PairList& pairs) {
    double weight = 0.0;
    for (const PairFit* pair : pairs)
        weight += pair->fit.information.bottomRightCorner<3, 3>().trace();
    return weight;
}

/// Accepted pairs by the two bodies that they join.
std::map<std::pair<std::size_t, std::size_t>, PairList> links(std::span<const PairFit> pairs,
                                                              std::span<const std::size_t> body) {
    std::map<std::pair<std::size_t, std::size_t>, PairList> between;
    for (const PairFit& pair : pairs) {
        const std::size_t a = body[pair.source], b = body[pair.target];
        if (pair.accepted && a != b) between[{std::min(a, b), std::max(a, b)}].push_back(&pair);
    }
    return between;
}

}  // namespace

std::vector<std::vector<WeakAxis>> loose_axes(std::span<const PairFit> pairs,
                                              std::span<const Eigen::Isometry3d> poses,
                                              std::span<const std::uint8_t> ground) {
    const std::size_t n = poses.size();
    std::vector<std::vector<WeakAxis>> axes(n);
    for (std::size_t i = 0; i < n; ++i) {
        if (!ground[i]) continue;
        PairList own;
        for (const PairFit& pair : pairs) {
            if (pair.accepted && (pair.source == i || pair.target == i)) own.push_back(&pair);
        }
        axes[i] = weak_axes(joint_information(own, poses));
    }

    // Bodies: scans that move as one. All of the ground is body 0.
    std::vector<std::size_t> body(n);
    for (std::size_t i = 0; i < n; ++i)
        body[i] = ground[i] ? 0 : i + 1;
    for (bool grown = true; grown;) {
        grown = false;
        for (const auto& [bodies, between] : links(pairs, body)) {
            if (!weak_axes(joint_information(between, poses)).empty()) continue;
            std::replace(body.begin(), body.end(), bodies.second, bodies.first);
            grown = true;
            break;  // the other links may join now
        }
    }
    std::map<std::size_t, double> strongest;
    for (const auto& [bodies, between] : links(pairs, body)) {
        const double weight = weight_of(between);
        const std::vector<WeakAxis> open = weak_axes(joint_information(between, poses));
        for (const std::size_t b : {bodies.first, bodies.second}) {
            if (b == 0 || weight <= strongest[b]) continue;
            strongest[b] = weight;
            for (std::size_t i = 0; i < n; ++i) {
                if (body[i] == b) axes[i] = open;
            }
        }
    }
    return axes;
}

std::vector<std::uint8_t> scans_in_loops(std::span<const PairFit> pairs, std::size_t scans) {
    // Dead ends are cut back until none is left.
    std::vector<std::uint8_t> inside(scans, 1);
    for (bool cut = true; cut;) {
        cut = false;
        std::vector<std::size_t> degree(scans);
        for (const PairFit& pair : pairs) {
            if (!pair.accepted || !inside[pair.source] || !inside[pair.target]) continue;
            ++degree[pair.source];
            ++degree[pair.target];
        }
        for (std::size_t i = 0; i < scans; ++i) {
            if (!inside[i] || degree[i] > 1) continue;
            inside[i] = 0;
            cut = true;
        }
    }
    return inside;
}

}  // namespace glowworm

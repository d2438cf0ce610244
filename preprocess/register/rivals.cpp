#include "preprocess/register/rivals.h"

#include <algorithm>
#include <cmath>

#include "preprocess/register/verification.h"

namespace glowworm {
namespace {

constexpr double kStep = 1.5;       // voxel sizes: the refinement reaches farther than half of it
constexpr double kTolerance = 2.0;  // voxel sizes: what lies within half a step still agrees
constexpr double kNearest = 3.0;    // voxel sizes: less is the same place
constexpr int kMostSteps = 60;      // each way
constexpr double kReach = 0.7;      // of the shorter scan: farther, little is seen in common
constexpr double kShare = 0.3;      // of the agreement at the fit: less is no rival
constexpr std::size_t kSamples = 300;
constexpr std::size_t kMostRivals = 6;
constexpr double kSameAxis = 0.97;  // cosine

/// Length of the samples along `axis` (unit, the model's frame), m, without their outer tenths.
double extent_along(const SurfaceSamples& samples, const Eigen::Vector3d& axis) {
    std::vector<float> along;
    const Eigen::Vector3f a = axis.cast<float>();
    for (const Vec3f& p : samples.positions)
        along.push_back(to_eigen(p).dot(a));
    if (along.empty()) return 0.0;
    const std::ptrdiff_t tenth = static_cast<std::ptrdiff_t>(along.size() / 10);
    std::nth_element(along.begin(), along.begin() + tenth, along.end());
    const float low = along[static_cast<std::size_t>(tenth)];
    std::nth_element(along.begin(), along.end() - 1 - tenth, along.end());
    return static_cast<double>(*(along.end() - 1 - tenth) - low);
}

}  // namespace

std::vector<Eigen::Isometry3d> slid_rivals(const ScanModel& source, const ScanModel& target,
                                           const Fit& fit, double voxel_size) {
    // The models lie in their main axes, the longest being X.
    const Eigen::Matrix3d R = fit.T_target_source.rotation();
    std::vector<Eigen::Vector3d> axes;
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(R.col(0)), Eigen::Vector3d::UnitX().eval(), Eigen::Vector3d(R.col(1)),
          Eigen::Vector3d::UnitY().eval()}) {
        const bool known = std::any_of(axes.begin(), axes.end(), [&](const Eigen::Vector3d& a) {
            return std::abs(a.dot(axis)) > kSameAxis;
        });
        if (!known) axes.push_back(axis);
    }

    const auto agreement = [&](const Eigen::Isometry3d& T) {
        return verify(source, target, T, kTolerance * voxel_size, kSamples).best_overlap();
    };
    const double least = kShare * agreement(fit.T_target_source);
    struct Rival {
        Eigen::Isometry3d T;
        double agreement;
    };
    std::vector<Rival> rivals;
    for (const Eigen::Vector3d& axis : axes) {
        const double shorter = std::min(extent_along(source.coarse, R.transpose() * axis),
                                        extent_along(target.coarse, axis));
        const double step = std::max(kStep * voxel_size, kReach * shorter / kMostSteps);
        const int steps = static_cast<int>(kReach * shorter / step);
        std::vector<Rival> slid;
        for (int i = -steps; i <= steps; ++i) {
            const Eigen::Isometry3d T(Eigen::Translation3d(i * step * axis) * fit.T_target_source);
            slid.push_back({T, agreement(T)});
        }
        for (int i = 0; i <= 2 * steps; ++i) {
            const auto at = [&](int k) {
                return k < 0 || k > 2 * steps ? 0.0 : slid[static_cast<std::size_t>(k)].agreement;
            };
            if (std::abs(i - steps) * step < kNearest * voxel_size) continue;
            if (at(i) >= least && at(i) >= at(i - 1) && at(i) >= at(i + 1))
                rivals.push_back(slid[static_cast<std::size_t>(i)]);
        }
    }
    std::stable_sort(rivals.begin(), rivals.end(),
                     [](const Rival& a, const Rival& b) { return a.agreement > b.agreement; });
    std::vector<Eigen::Isometry3d> poses;
    for (std::size_t i = 0; i < std::min(rivals.size(), kMostRivals); ++i)
        poses.push_back(rivals[i].T);
    return poses;
}

}  // namespace glowworm

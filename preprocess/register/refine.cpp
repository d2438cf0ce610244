#include "preprocess/register/refine.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace glowworm {
namespace {

constexpr float kNormalsAgree = 0.6f;  // cosine
constexpr std::size_t kBlock = 512;    // samples summed together, in fixed order
constexpr std::size_t kFewestPartners = 30;
constexpr double kMadToSigma = 1.4826;
constexpr double kLossScale = 2.0;  // in sigmas
constexpr double kSurest = 0.01;    // in spacings: no place is known better than this

struct Partner {
    Eigen::Vector3d place, normal;  // of the moved source sample; mean of the two normals
    double residual = 0;            // m
    double weight = 1;              // 1: as sure as the average partner
    bool found = false;
};

using Vector6d = Eigen::Matrix<double, 6, 1>;

struct Sums {
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
};

double quantile(std::vector<double> values, double q) {
    if (values.empty()) return 0.0;
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

struct Partners {
    std::vector<Partner> all;  // also those without a partner
    double expected = 0;       // m, rms of the weighted residuals; 0: not known
};

/// Pairs every `step`-th source sample with its nearest target sample. Weights: one over the
/// variance of the residual, their mean being 1.
Partners find_partners(const SurfaceSamples& source, const SurfaceSamples& target,
                       const Eigen::Isometry3d& T, std::size_t step, float gate) {
    const Eigen::Isometry3f Tf = T.cast<float>();
    const Eigen::Matrix3f R = Tf.linear();
    const std::size_t count = (source.size() + step - 1) / step;
    std::vector<Partner> partners(count);
    const double floor = std::pow(kSurest * target.spacing, 2);
    const bool variances_known = !source.variances.empty() && !target.variances.empty();
    tbb::parallel_for(std::size_t{0}, (count + kBlock - 1) / kBlock, [&](std::size_t block) {
        for (std::size_t k = block * kBlock; k < std::min(count, (block + 1) * kBlock); ++k) {
            const Eigen::Vector3f place = Tf * to_eigen(source.positions[k * step]);
            const Neighbour nearest = target.tree.nearest(to_vec3(place), gate);
            if (!nearest.found()) continue;
            const Eigen::Vector3f n = R * to_eigen(source.normals[k * step]);
            const Eigen::Vector3f m = to_eigen(target.normals[nearest.index]);
            if (n.dot(m) < kNormalsAgree) continue;
            const Eigen::Vector3f q = to_eigen(target.positions[nearest.index]);
            Partner& partner = partners[k];
            partner.normal = (n + m).normalized().cast<double>();
            partner.place = place.cast<double>();
            partner.residual = partner.normal.dot((place - q).cast<double>());
            partner.found = true;
            if (variances_known) {
                partner.weight =
                    1.0 / (static_cast<double>(source.variances[k * step]) +
                           static_cast<double>(target.variances[nearest.index]) + floor);
            }
        }
    });
    double sum = 0.0, found = 0.0;
    for (const Partner& p : partners) {
        if (!p.found) continue;
        sum += p.weight;
        found += 1.0;
    }
    for (Partner& p : partners)
        p.weight *= found / sum;
    return {std::move(partners), variances_known && sum > 0.0 ? std::sqrt(found / sum) : 0.0};
}

Sums sum_up(std::span<const Partner> partners, const Eigen::Vector3d& centre, double scale) {
    const std::size_t blocks = (partners.size() + kBlock - 1) / kBlock;
    std::vector<Sums> partial(blocks);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
        Sums sums;
        for (std::size_t k = block * kBlock; k < std::min(partners.size(), (block + 1) * kBlock);
             ++k) {
            const Partner& p = partners[k];
            if (!p.found) continue;
            Vector6d J;
            J << (p.place - centre).cross(p.normal), p.normal;
            const double surprise = p.weight * p.residual * p.residual;
            const double ratio = scale * scale / (scale * scale + surprise);
            const double weight = p.weight * ratio * ratio;
            sums.H.noalias() += weight * J * J.transpose();
            sums.g += weight * p.residual * J;
        }
        partial[block] = sums;
    });
    Sums total;
    for (const Sums& s : partial) {
        total.H += s.H;
        total.g += s.g;
    }
    return total;
}

/// The step that lessens the residuals; with `upright` without a turn about X or Y.
Vector6d solve(const Sums& sums, bool upright) {
    // A breath of damping: a direction that nothing holds stays where it is.
    Matrix6d H = sums.H;
    H.diagonal().array() += 1e-9 * H.trace();
    if (!upright) return -H.ldlt().solve(sums.g);
    const Eigen::Matrix4d H4 = H.bottomRightCorner<4, 4>();
    Vector6d step = Vector6d::Zero();
    step.tail<4>() = -H4.ldlt().solve(sums.g.tail<4>());
    return step;
}

Eigen::Isometry3d motion(const Vector6d& step, const Eigen::Vector3d& centre) {
    const Eigen::Vector3d turn = step.head<3>();
    const double angle = turn.norm();
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    if (angle > 0.0) T.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    T.translation() = centre + step.tail<3>() - T.linear() * centre;
    return T;
}

}  // namespace

Fit refine(const SurfaceSamples& source, const SurfaceSamples& target,
           const Eigen::Isometry3d& T_target_source, const RefineSettings& settings) {
    Fit fit{.T_target_source = T_target_source};
    const std::size_t step =
        std::max<std::size_t>(1, (source.size() + settings.max_samples - 1) / settings.max_samples);
    double gate = settings.gate;
    for (int iteration = 0; iteration < settings.max_iterations; ++iteration) {
        const auto [partners, expected] =
            find_partners(source, target, fit.T_target_source, step, static_cast<float>(gate));
        std::vector<double> distances;
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();
        for (const Partner& p : partners) {
            if (!p.found) continue;
            distances.push_back(std::sqrt(p.weight) * std::abs(p.residual));
            centre += p.place;
        }
        fit.inliers = distances.size();
        if (fit.inliers < kFewestPartners) return fit;
        centre /= static_cast<double>(fit.inliers);
        double spread = 0.0;
        for (const Partner& p : partners) {
            if (p.found) spread += (p.place - centre).squaredNorm();
        }
        fit.extent = std::sqrt(spread / static_cast<double>(fit.inliers));
        fit.centre = centre;

        const double sigma = kMadToSigma * quantile(distances, 0.5);
        const double scale = kLossScale * std::max(sigma, 1e-6 * fit.extent + 1e-12);
        const Sums sums = sum_up(partners, centre, scale);
        fit.information = sums.H;
        double squares = 0.0;
        for (const double d : distances)
            squares += d * d;
        fit.rmse = std::sqrt(squares / static_cast<double>(fit.inliers));
        fit.p95 = quantile(distances, 0.95);
        fit.expected = expected;
        if (fit.converged) break;  // the last pass only looked

        const Vector6d delta = solve(sums, settings.upright);
        fit.T_target_source = motion(delta, centre) * fit.T_target_source;
        const double moved = delta.head<3>().norm() * fit.extent + delta.tail<3>().norm();
        const bool closed = gate <= settings.final_gate;
        if (closed && moved < 1e-6 * fit.extent) fit.converged = true;
        // The gate closes as fast as the alignment settles.
        gate = std::max(settings.final_gate, std::min(0.7 * gate, 3.0 * sigma + 10.0 * moved));
    }
    // Rotations multiplied many times drift from orthonormal.
    fit.T_target_source.linear() =
        Eigen::Quaterniond(fit.T_target_source.linear()).normalized().toRotationMatrix();
    return fit;
}

}  // namespace glowworm

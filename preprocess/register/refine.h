#pragma once

#include <Eigen/Geometry>
#include <cstddef>

#include "preprocess/register/scan_model.h"

namespace glowworm {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct RefineSettings {
    double gate = 0.3;        ///< m, > 0: correspondences farther apart are not believed
    double final_gate = 0.1;  ///< m, in (0, gate]: the gate closes to this while it converges
    bool upright = false;     ///< only a turn about Z and a shift
    std::size_t max_samples = 8000;  ///< of the source, taken evenly
    int max_iterations = 40;
};

/// How two surfaces lie after a fine alignment.
struct Fit {
    Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
    bool converged = false;
    std::size_t inliers = 0;  ///< samples with a partner within the final gate
    double rmse = 0;          ///< m, of the inliers' distances to the partner's surface, the surer
                              ///< ones counting more
    double p95 = 0;           ///< m
    double expected = 0;      ///< m, what the samples' variances make of the rmse; 0: not known
    /// Sum of wᵢJᵢᵀJᵢ over the inliers for a turn (radians) about `centre` and a shift (m), target
    /// frame: the inverse of the covariance, times the variance of a residual.
    Matrix6d information = Matrix6d::Zero();
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the inliers, target frame
    double extent = 0;  ///< m, rms distance of the inliers from the centre
};

/// Symmetric point-to-plane ICP (Rusinkiewicz 2019), exact for surfaces of constant curvature, with
/// residuals weighted by the samples' variances and a Geman-McClure loss whose scale follows them,
/// from `T_target_source`. Stops when the motion of a step is below 1e-6 of the
/// samples' extent. Too few partners: `converged` is false and `inliers` tells.
Fit refine(const SurfaceSamples& source, const SurfaceSamples& target,
           const Eigen::Isometry3d& T_target_source, const RefineSettings& settings);

}  // namespace glowworm

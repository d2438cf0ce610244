#include "preprocess/register/pose_graph.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <cmath>

namespace glowworm {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kResidualInflation = 10.0;  // neighbouring residuals are not independent
constexpr double kCauchyScale = 3.0;         // in sigmas

/// The turn and the shift at `centre` that lead from the measured to the predicted pose.
template <typename T>
Eigen::Matrix<T, 6, 1> difference(const Eigen::Matrix<T, 3, 3>& R_target_source,
                                  const Eigen::Matrix<T, 3, 1>& t_target_source,
                                  const PoseEdge& edge) {
    const Eigen::Matrix3d Rm = edge.T_target_source.rotation();
    const Eigen::Vector3d at_source = edge.T_target_source.inverse() * edge.centre;
    const Eigen::Matrix<T, 3, 3> turn = R_target_source * Rm.transpose().cast<T>();
    Eigen::Matrix<T, 6, 1> result;
    Eigen::Matrix<T, 3, 1> angle_axis;
    ceres::RotationMatrixToAngleAxis(ceres::ColumnMajorAdapter3x3(turn.data()), angle_axis.data());
    result.template head<3>() = angle_axis;
    result.template tail<3>() =
        R_target_source * at_source.cast<T>() + t_target_source - edge.centre.cast<T>();
    return result;
}

struct EdgeCost {
    PoseEdge edge;
    Matrix6d whitening;

    template <typename T>
    bool operator()(const T* qt, const T* tt, const T* qs, const T* ts, T* residual) const {
        const Eigen::Map<const Eigen::Quaternion<T>> target(qt), source(qs);
        const Eigen::Map<const Eigen::Matrix<T, 3, 1>> t_target(tt), t_source(ts);
        const Eigen::Matrix<T, 3, 3> Rt = target.toRotationMatrix().transpose();
        const Eigen::Matrix<T, 3, 3> R = Rt * source.toRotationMatrix();
        const Eigen::Matrix<T, 3, 1> t = Rt * (t_source - t_target);
        Eigen::Map<Eigen::Matrix<T, 6, 1>> out(residual);
        out = whitening.cast<T>() * difference<T>(R, t, edge);
        return true;
    }
};

/// W with WᵀW = covariance⁻¹.
Matrix6d whitening(const Matrix6d& covariance) {
    const Eigen::LLT<Matrix6d> factor(covariance);
    return factor.matrixL().solve(Matrix6d::Identity());
}

/// Turns about world Z: q ← exp(δ/2 ẑ)·q.
class YawManifold : public ceres::Manifold {
  public:
    int AmbientSize() const override { return 4; }
    int TangentSize() const override { return 1; }
    bool Plus(const double* x, const double* delta, double* result) const override {
        const Eigen::Map<const Eigen::Quaterniond> q(x);
        Eigen::Map<Eigen::Quaterniond> out(result);
        out = (Eigen::AngleAxisd(delta[0], Eigen::Vector3d::UnitZ()) * q).normalized();
        return true;
    }
    bool PlusJacobian(const double* x, double* jacobian) const override {
        // d/dδ of (0, 0, δ/2, 1)·q, in the order x, y, z, w
        jacobian[0] = -0.5 * x[1];
        jacobian[1] = 0.5 * x[0];
        jacobian[2] = 0.5 * x[3];
        jacobian[3] = -0.5 * x[2];
        return true;
    }
    bool Minus(const double* y, const double* x, double* delta) const override {
        const Eigen::Map<const Eigen::Quaterniond> a(x), b(y);
        const Eigen::AngleAxisd turn(b * a.conjugate());
        delta[0] = turn.angle() * turn.axis().z();
        return true;
    }
    bool MinusJacobian(const double* x, double* jacobian) const override {
        jacobian[0] = -2.0 * x[1];
        jacobian[1] = 2.0 * x[0];
        jacobian[2] = 2.0 * x[3];
        jacobian[3] = -2.0 * x[2];
        return true;
    }
};

}  // namespace

PoseEdge make_edge(std::size_t source, std::size_t target, const Fit& fit, double floor) {
    PoseEdge edge{.source = source,
                  .target = target,
                  .T_target_source = fit.T_target_source,
                  .centre = fit.centre,
                  .extent = std::max(fit.extent, floor)};
    // A direction nothing holds gets a large but finite variance: at most its own extent.
    Matrix6d information = fit.information / (kResidualInflation * fit.rmse * fit.rmse + 1e-12);
    Vector6d least;
    least << Eigen::Vector3d::Constant(1.0),
        Eigen::Vector3d::Constant(1.0 / (edge.extent * edge.extent));
    information.diagonal() += least;
    edge.covariance = information.ldlt().solve(Matrix6d::Identity());
    edge.covariance = 0.5 * (edge.covariance + edge.covariance.transpose().eval());
    Vector6d variance;
    variance << Eigen::Vector3d::Constant(std::pow(floor / edge.extent, 2)),
        Eigen::Vector3d::Constant(floor * floor);
    edge.covariance.diagonal() += variance;
    return edge;
}

Misclosure misclosure(const PoseEdge& edge, std::span<const Eigen::Isometry3d> poses) {
    const Eigen::Isometry3d predicted = poses[edge.target].inverse() * poses[edge.source];
    const Vector6d d = difference<double>(predicted.rotation(), predicted.translation(), edge);
    return {d.tail<3>().norm(), d.head<3>().norm(),
            (whitening(edge.covariance) * d).norm() / std::sqrt(6.0)};
}

void solve_pose_graph(std::vector<Eigen::Isometry3d>& poses, std::span<const PoseEdge> edges,
                      std::span<const std::uint8_t> fixed, bool upright) {
    if (edges.empty()) return;
    std::vector<Eigen::Quaterniond> rotations;
    std::vector<Eigen::Vector3d> places;
    for (const Eigen::Isometry3d& pose : poses) {
        rotations.emplace_back(pose.rotation());
        places.emplace_back(pose.translation());
    }
    ceres::Problem problem;
    for (const PoseEdge& edge : edges) {
        auto* cost = new ceres::AutoDiffCostFunction<EdgeCost, 6, 4, 3, 4, 3>(
            new EdgeCost{edge, whitening(edge.covariance)});
        problem.AddResidualBlock(cost, new ceres::CauchyLoss(kCauchyScale),
                                 rotations[edge.target].coeffs().data(), places[edge.target].data(),
                                 rotations[edge.source].coeffs().data(),
                                 places[edge.source].data());
    }
    for (std::size_t i = 0; i < poses.size(); ++i) {
        double* rotation = rotations[i].coeffs().data();
        if (!problem.HasParameterBlock(rotation)) continue;
        if (upright) {
            problem.SetManifold(rotation, new YawManifold);
        } else {
            problem.SetManifold(rotation, new ceres::EigenQuaternionManifold);
        }
        if (!fixed[i]) continue;
        problem.SetParameterBlockConstant(rotation);
        problem.SetParameterBlockConstant(places[i].data());
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-12;
    options.num_threads = 1;  // sums in one order
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable()) return;  // the start is kept; misclosures will tell
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (fixed[i]) continue;
        poses[i].linear() = rotations[i].normalized().toRotationMatrix();
        poses[i].translation() = places[i];
    }
}

}  // namespace glowworm

#include "preprocess/register/trust.h"

#include <Eigen/Eigenvalues>

namespace glowworm {

std::vector<WeakAxis> weak_axes(const Fit& fit) {
    // The trace of the shift's block is the sum of the weights: normals are unit.
    const double weight = fit.information.bottomRightCorner<3, 3>().trace();
    if (weight <= 0.0 || fit.extent <= 0.0) return {};
    Matrix6d scaled = fit.information / weight;
    scaled.topRows<3>() /= fit.extent;
    scaled.leftCols<3>() /= fit.extent;
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(scaled);

    std::vector<WeakAxis> axes;
    for (int i = 0; i < 6; ++i) {
        if (solver.eigenvalues()[i] >= kWeakInformation) break;
        const Eigen::Matrix<double, 6, 1> v = solver.eigenvectors().col(i);
        const bool rotation = v.head<3>().norm() > v.tail<3>().norm();
        const Eigen::Vector3d axis = (rotation ? v.head<3>() : v.tail<3>()).normalized();
        axes.push_back({rotation, {axis.x(), axis.y(), axis.z()}, solver.eigenvalues()[i]});
    }
    return axes;
}

std::vector<WeakAxis> rotate(std::vector<WeakAxis> axes, const Eigen::Isometry3d& T_world_target) {
    for (WeakAxis& weak : axes) {
        const Eigen::Vector3d turned =
            T_world_target.rotation() * Eigen::Vector3d(weak.axis.x, weak.axis.y, weak.axis.z);
        weak.axis = {turned.x(), turned.y(), turned.z()};
    }
    return axes;
}

}  // namespace glowworm

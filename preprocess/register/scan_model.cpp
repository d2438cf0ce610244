#include "preprocess/register/scan_model.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "preprocess/clean.h"
#include "preprocess/register/orient.h"
#include "preprocess/register/patches.h"

namespace glowworm {
namespace {

constexpr std::size_t kPlaneNeighbours = 13;  // the sample itself and 12 around it
constexpr std::size_t kFewestNeighbours = 6;
constexpr float kPlaneRadius = 3.0f;  // in spacings

constexpr double kFineSpacing = 0.5;   // in coarse spacings
constexpr double kWideSpacing = 1.5;   // in coarse spacings
constexpr double kFinestShare = 1e-5;  // of the largest scan: least voxel size
constexpr double kPointsPerSample = 2.5;
constexpr std::size_t kSubset = 100000;  // points that the voxel size is chosen by

struct Plane {
    Eigen::Vector3f normal;
    Eigen::Vector3f centre;
};

std::optional<Plane> fit_plane(const KdTree& tree, std::span<const Vec3f> positions,
                               const Vec3f& at, float radius) {
    std::array<Neighbour, kPlaneNeighbours> found;
    const std::size_t n = tree.nearest(at, found, radius);
    if (n < kFewestNeighbours) return std::nullopt;
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    for (std::size_t i = 0; i < n; ++i)
        mean += to_eigen(positions[found[i].index] - at);
    mean /= static_cast<float>(n);
    Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
    for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector3f d = to_eigen(positions[found[i].index] - at) - mean;
        covariance += d * d.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
    solver.computeDirect(covariance);
    // Neighbours on one line hold no plane.
    if (solver.eigenvalues()[1] < 0.02f * solver.eigenvalues()[2]) return std::nullopt;
    return Plane{solver.eigenvectors().col(0).normalized(), mean + to_eigen(at)};
}

std::vector<Vec3f> turn(std::span<const Vec3f> positions, const Eigen::Matrix3d& R) {
    std::vector<Vec3f> turned(positions.size());
    tbb::parallel_for(std::size_t{0}, positions.size(), [&](std::size_t i) {
        const Eigen::Vector3d p = R * to_eigen(positions[i]).cast<double>();
        turned[i] = to_vec3(p.cast<float>());
    });
    return turned;
}

}  // namespace

SurfaceSamples sample_surface(std::span<const Vec3f> positions, double spacing,
                              const std::optional<Vec3f>& viewpoint) {
    std::vector<Vec3f> thinned;
    for (const std::uint32_t i : thin_indices(positions, spacing))
        thinned.push_back(positions[i]);
    const KdTree tree(thinned);
    std::vector<std::optional<Plane>> planes(thinned.size());
    const float radius = kPlaneRadius * static_cast<float>(spacing);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, thinned.size(), 256),
                      [&](const auto& range) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                              planes[i] = fit_plane(tree, thinned, thinned[i], radius);
                          }
                      });

    SurfaceSamples samples;
    samples.spacing = spacing;
    for (std::size_t i = 0; i < thinned.size(); ++i) {
        if (!planes[i]) continue;
        const Eigen::Vector3f p = to_eigen(thinned[i]), n = planes[i]->normal;
        samples.positions.push_back(to_vec3(p - n * n.dot(p - planes[i]->centre)));
        samples.normals.push_back(to_vec3(n));
    }
    samples.tree = KdTree(samples.positions);
    if (viewpoint) {
        face_viewpoint(samples.positions, samples.normals, *viewpoint);
    } else {
        agree_with_neighbours(samples.positions, samples.normals, samples.tree);
    }
    return samples;
}

Eigen::Matrix3d main_axes(std::span<const Vec3f> positions, bool upright) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double count = 0.0;
    for (const Vec3f& p : positions) {
        if (!is_finite(p)) continue;
        mean += to_eigen(p).cast<double>();
        count += 1.0;
    }
    if (count < 3.0) return Eigen::Matrix3d::Identity();
    mean /= count;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Vec3f& p : positions) {
        if (!is_finite(p)) continue;
        Eigen::Vector3d d = to_eigen(p).cast<double>() - mean;
        if (upright) d.z() = 0.0;
        covariance += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    Eigen::Vector3d x = solver.eigenvectors().col(2), y = solver.eigenvectors().col(1);
    double x_tail = 0.0, y_tail = 0.0;
    for (const Vec3f& p : positions) {
        if (!is_finite(p)) continue;
        const Eigen::Vector3d d = to_eigen(p).cast<double>() - mean;
        x_tail += std::pow(d.dot(x), 3);
        y_tail += std::pow(d.dot(y), 3);
    }
    if (x_tail < 0.0) x = -x;
    if (y_tail < 0.0) y = -y;
    if (upright) y = Eigen::Vector3d::UnitZ().cross(x);
    Eigen::Matrix3d R;
    R << x.transpose(), y.transpose(), x.cross(y).transpose();
    return R;
}

ScanModel model_scan(const Scan& scan, double spacing, bool upright, bool toward_viewpoint) {
    ScanModel model;
    model.R_model_scan = main_axes(scan.points.positions, upright);
    const std::vector<Vec3f> turned = turn(scan.points.positions, model.R_model_scan);
    std::optional<Vec3f> viewpoint;
    if (scan.has_viewpoint) {
        const Vec3d place = -scan.offset;
        const Eigen::Vector3d v = model.R_model_scan * Eigen::Vector3d(place.x, place.y, place.z);
        model.viewpoint = to_vec3(v.cast<float>());
        if (toward_viewpoint) viewpoint = model.viewpoint;
        std::vector<Vec3f> seen = turned;
        for (Vec3f& p : seen)
            p -= model.viewpoint;
        model.depths.emplace(seen);
    }
    model.coarse = sample_surface(turned, spacing, viewpoint);
    model.fine = sample_patches(turned, kFineSpacing * spacing, viewpoint);
    model.wide = sample_surface(turned, kWideSpacing * spacing, viewpoint);
    return model;
}

double choose_voxel_size(std::span<const Scan> scans, bool upright, std::size_t samples) {
    std::vector<double> sizes(scans.size()), extents(scans.size());
    tbb::parallel_for(std::size_t{0}, scans.size(), [&](std::size_t s) {
        const std::vector<Vec3f>& positions = scans[s].points.positions;
        // An even subset is enough to find the size by.
        std::vector<Vec3f> subset;
        const std::size_t stride = std::max<std::size_t>(1, positions.size() / kSubset);
        for (std::size_t i = 0; i < positions.size(); i += stride) {
            if (is_finite(positions[i])) subset.push_back(positions[i]);
        }
        if (subset.empty()) return;
        subset = turn(subset, main_axes(subset, upright));
        Vec3f low = subset[0], high = low;
        for (const Vec3f& p : subset) {
            low = component_min(low, p);
            high = component_max(high, p);
        }
        extents[s] = static_cast<double>(length(high - low));
        // A sample needs points around it: sparse scans get fewer samples rather than bare ones.
        const std::size_t wanted = std::min(
            samples,
            static_cast<std::size_t>(static_cast<double>(subset.size()) / kPointsPerSample));
        double most = std::max(extents[s], 1e-6) / 2.0;
        double least = most / 65536.0;
        for (int round = 0; round < 18; ++round) {
            const double middle = std::sqrt(least * most);
            (thin_indices(subset, middle).size() > wanted ? least : most) = middle;
        }
        sizes[s] = most;
    });
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    // A scan of one place beside one of a mountain: no grid can be that fine.
    return std::max(*middle, *std::max_element(extents.begin(), extents.end()) * kFinestShare);
}

}  // namespace glowworm

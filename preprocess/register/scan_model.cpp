#include "preprocess/register/scan_model.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "preprocess/clean.h"
#include "preprocess/register/orient.h"

namespace glowworm {
namespace {

constexpr std::size_t kPlaneNeighbours = 13;  // the sample itself and 12 around it
constexpr std::size_t kFewestNeighbours = 6;
constexpr float kPlaneRadius = 3.0f;  // in spacings

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

ScanModel model_scan(const Scan& scan, double spacing) {
    ScanModel model;
    std::optional<Vec3f> viewpoint;
    if (scan.has_viewpoint) {
        viewpoint = vec3_cast<float>(-scan.offset);
        model.viewpoint = *viewpoint;
        std::vector<Vec3f> seen = scan.points.positions;
        for (Vec3f& p : seen)
            p -= *viewpoint;
        model.depths.emplace(seen);
    }
    // Strays stand alone; a thinned voxel would make them as weighty as a wall.
    std::vector<Vec3f> clean;
    for (const std::uint32_t i : inlier_indices(scan.points.positions, scan.has_viewpoint)) {
        clean.push_back(scan.points.positions[i]);
    }
    model.coarse = sample_surface(clean, spacing, viewpoint);
    model.fine = sample_surface(clean, spacing / 2.0, viewpoint);
    return model;
}

double choose_voxel_size(std::span<const Scan> scans, std::size_t samples) {
    std::vector<double> sizes(scans.size());
    tbb::parallel_for(std::size_t{0}, scans.size(), [&](std::size_t s) {
        const std::vector<Vec3f>& positions = scans[s].points.positions;
        // An even subset is enough to find the size by.
        std::vector<Vec3f> subset;
        const std::size_t step = std::max<std::size_t>(1, positions.size() / 100000);
        for (std::size_t i = 0; i < positions.size(); i += step)
            subset.push_back(positions[i]);
        std::vector<float> ranges;
        Vec3d mean;
        for (const Vec3f& p : subset) {
            if (is_finite(p)) mean += vec3_cast<double>(p);
        }
        mean = mean / static_cast<double>(std::max<std::size_t>(1, subset.size()));
        for (const Vec3f& p : subset) {
            if (is_finite(p)) ranges.push_back(length(p - vec3_cast<float>(mean)));
        }
        if (ranges.empty()) return;
        const auto far = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() * 9 / 10);
        std::nth_element(ranges.begin(), far, ranges.end());
        double high = std::max(static_cast<double>(*far), 1e-6) / 4.0, low = high / 4096.0;
        for (int step_count = 0; step_count < 12; ++step_count) {
            const double middle = std::sqrt(low * high);
            (thin_indices(subset, middle).size() > samples ? low : high) = middle;
        }
        sizes[s] = high;
    });
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return *middle;
}

}  // namespace glowworm

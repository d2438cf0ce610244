#include "preprocess/register/patches.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "preprocess/clean.h"
#include "preprocess/register/orient.h"

namespace glowworm {
namespace {

constexpr double kSupportSpacing = 0.25;  // in spacings: finer points add nothing to a fit
constexpr std::size_t kNeighbours = 32;
constexpr std::size_t kFewestNeighbours = 12;  // twice the unknowns of a quadric
constexpr float kRadius = 6.0f;                // in spacings: farther points are not its surface
constexpr float kFlattest = 0.02f;             // share of the longest: less is a line, not a patch

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Matrix6f = Eigen::Matrix<float, 6, 6>;

struct Patch {
    Eigen::Vector3f place;  // relative to the point it was asked for
    Eigen::Vector3f normal;
    float variance;  // m², of the place along the normal
};

std::optional<Patch> fit_patch(std::span<const Vec3f> positions, const Vec3f& at,
                               std::span<const Neighbour> found) {
    const float n = static_cast<float>(found.size());
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    for (const Neighbour& f : found)
        mean += to_eigen(positions[f.index] - at) / n;
    Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
    for (const Neighbour& f : found) {
        const Eigen::Vector3f d = to_eigen(positions[f.index] - at) - mean;
        covariance += d * d.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
    solver.computeDirect(covariance);
    if (!(solver.eigenvalues()[1] > kFlattest * solver.eigenvalues()[2])) return std::nullopt;
    const Eigen::Matrix3f axes = solver.eigenvectors();  // normal, then the plane's two

    // Heights over the plane, coordinates in units of the neighbourhood's size.
    const float size = std::sqrt(found.back().squared_distance);
    Matrix6f H = Matrix6f::Zero();
    Vector6f g = Vector6f::Zero();
    float squares = 0.0f;
    for (const Neighbour& f : found) {
        const Eigen::Vector3f d = axes.transpose() * to_eigen(positions[f.index] - at) / size;
        Vector6f row;
        row << 1.0f, d.y(), d.z(), d.y() * d.y(), d.y() * d.z(), d.z() * d.z();
        H.noalias() += row * row.transpose();
        g += row * d.x();
        squares += d.x() * d.x();
    }
    const Eigen::LDLT<Matrix6f> factor(H);
    if (!(factor.vectorD().minCoeff() > 1e-5f * n)) return std::nullopt;
    const Vector6f c = factor.solve(g);
    const float leverage = factor.solve(Vector6f::Unit(0))[0];
    const float noise = std::max(squares - c.dot(g), 0.0f) / (n - 6.0f);
    const Eigen::Vector3f slope(1.0f, -c[1], -c[2]);
    return Patch{axes.col(0) * (c[0] * size), (axes * slope).normalized(),
                 noise * leverage * size * size};
}

}  // namespace

SurfaceSamples sample_patches(std::span<const Vec3f> positions, double spacing,
                              const std::optional<Vec3f>& viewpoint) {
    std::vector<Vec3f> support, seeds;
    for (const std::uint32_t i : thin_indices(positions, kSupportSpacing * spacing))
        support.push_back(positions[i]);
    for (const std::uint32_t i : thin_indices(support, spacing))
        seeds.push_back(support[i]);
    const KdTree tree(support);
    std::vector<std::optional<Patch>> patches(seeds.size());
    const float radius = kRadius * static_cast<float>(spacing);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, seeds.size(), 256),
                      [&](const auto& range) {
                          std::array<Neighbour, kNeighbours> found;
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                              const std::size_t n = tree.nearest(seeds[i], found, radius);
                              if (n < kFewestNeighbours) continue;
                              patches[i] = fit_patch(support, seeds[i], std::span(found).first(n));
                          }
                      });

    SurfaceSamples samples;
    samples.spacing = spacing;
    for (std::size_t i = 0; i < seeds.size(); ++i) {
        if (!patches[i]) continue;
        samples.positions.push_back(seeds[i] + to_vec3(patches[i]->place));
        samples.normals.push_back(to_vec3(patches[i]->normal));
        samples.variances.push_back(patches[i]->variance);
    }
    samples.tree = KdTree(samples.positions);
    if (viewpoint) {
        face_viewpoint(samples.positions, samples.normals, *viewpoint);
    } else {
        agree_with_neighbours(samples.positions, samples.normals, samples.tree);
    }
    return samples;
}

}  // namespace glowworm

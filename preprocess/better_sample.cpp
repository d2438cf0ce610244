#include "preprocess/better_sample.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "octree/error.h"

namespace glowworm {
namespace {

constexpr double kPlaneCells = 4.0;  // edge of the cells that planes are fitted in, in spacings
constexpr std::size_t kFewestForPlane = 6;
constexpr float kLeastCosine = 0.1f;

struct CellSample {
    std::uint64_t cell;
    float cost;
    std::uint32_t index;
    bool operator<(const CellSample& o) const {
        if (cell != o.cell) return cell < o.cell;
        return cost != o.cost ? cost < o.cost : index < o.index;
    }
};

std::uint64_t cell_of(const Vec3f& p, const Vec3f& low, double edge) {
    const Vec3d d = (vec3_cast<double>(p) - vec3_cast<double>(low)) / edge;
    return static_cast<std::uint64_t>(d.z) << 42 | static_cast<std::uint64_t>(d.y) << 21 |
           static_cast<std::uint64_t>(d.x);
}

/// Samples by cell, costs 0.
std::vector<CellSample> by_cell(std::span<const Vec3f> positions, const Vec3f& low, double edge) {
    std::vector<CellSample> samples(positions.size());
    tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(positions.size()),
                      [&](std::uint32_t i) {
                          samples[i] = {cell_of(positions[i], low, edge), 0.0f, i};
                      });
    tbb::parallel_sort(samples.begin(), samples.end());
    return samples;
}

/// Per point the normal of the plane through its cell's points; zero where they are too few.
std::vector<Vec3f> cell_normals(std::span<const Vec3f> positions, const Vec3f& low, double edge) {
    const std::vector<CellSample> samples = by_cell(positions, low, edge);
    std::vector<Vec3f> normals(positions.size());
    for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
        Vec3d sum;
        for (end = begin; end < samples.size() && samples[end].cell == samples[begin].cell; ++end) {
            sum += vec3_cast<double>(positions[samples[end].index]);
        }
        if (end - begin < kFewestForPlane) continue;
        const Vec3d mean = sum / static_cast<double>(end - begin);
        Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d d = vec3_cast<double>(positions[samples[i].index]) - mean;
            const Eigen::Vector3d e(d.x, d.y, d.z);
            covariance += e * e.transpose();
        }
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
        solver.computeDirect(covariance);
        const Eigen::Vector3f n = solver.eigenvectors().col(0).cast<float>();
        for (std::size_t i = begin; i < end; ++i)
            normals[samples[i].index] = {n.x(), n.y(), n.z()};
    }
    return normals;
}

}  // namespace

std::vector<std::uint32_t> best_samples(const Points& points, double spacing,
                                        std::span<const Vec3f> stations,
                                        std::span<const std::uint8_t> has_viewpoint, float far) {
    if (points.empty()) return {};
    Vec3f low = points.positions.front(), high = low;
    for (const Vec3f& p : points.positions) {
        low = component_min(low, p);
        high = component_max(high, p);
    }
    const Vec3f extent = high - low;
    const double longest = static_cast<double>(std::max({extent.x, extent.y, extent.z}));
    if (!(longest / spacing < 2097151.0)) {
        throw Error(ExitCode::kUsage, "a spacing of " + std::to_string(spacing) +
                                          " m is too fine to merge scans that span " +
                                          std::to_string(longest) + " m; use at least " +
                                          std::to_string(longest / 2097150.0) + " m");
    }
    const std::vector<Vec3f> planes =
        points.normals.empty() ? cell_normals(points.positions, low, kPlaneCells * spacing)
                               : std::vector<Vec3f>{};
    const std::vector<Vec3f>& normals = points.normals.empty() ? planes : points.normals;

    std::vector<CellSample> samples = by_cell(points.positions, low, spacing);
    tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
        const std::uint32_t index = samples[i].index;
        const std::uint32_t station = points.stations[index];
        samples[i].cost = far / kLeastCosine;
        if (!has_viewpoint[station]) return;
        const Vec3f ray = stations[station] - points.positions[index];
        const float range = length(ray);
        const float cosine = range > 0.0f ? std::abs(dot(normals[index], ray)) / range : 1.0f;
        samples[i].cost = range / std::max(cosine, kLeastCosine);
    });
    tbb::parallel_sort(samples.begin(), samples.end());
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (i == 0 || samples[i].cell != samples[i - 1].cell) kept.push_back(samples[i].index);
    }
    std::sort(kept.begin(), kept.end());
    return kept;
}

}  // namespace glowworm

#include "preprocess/clean.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "octree/error.h"
#include "preprocess/kd_tree.h"

namespace glowworm {
namespace {

constexpr std::uint32_t kMaxNeighbours = 64;
constexpr std::uint64_t kMaxCells = std::uint64_t{1} << 21;

struct CellPoint {
    std::uint64_t cell;
    std::uint32_t index;
    bool operator<(const CellPoint& o) const {
        return cell != o.cell ? cell < o.cell : index < o.index;
    }
};

std::vector<std::uint32_t> finite_indices(std::span<const Vec3f> positions) {
    std::vector<std::uint32_t> finite;
    finite.reserve(positions.size());
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        if (is_finite(positions[i])) finite.push_back(i);
    }
    return finite;
}

/// Mean distance of each point in `finite` to its k nearest others, at the point's index; their
/// indices, [finite.size() * k], where `neighbours` is given.
std::vector<float> mean_distances(std::span<const Vec3f> positions,
                                  std::span<const std::uint32_t> finite, std::uint32_t k,
                                  std::vector<std::uint32_t>* neighbours) {
    const KdTree tree(positions);
    std::vector<float> mean(positions.size(), 0.0f);
    if (neighbours != nullptr) neighbours->resize(finite.size() * k);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, finite.size(), 512),
                      [&](const auto& range) {
                          std::array<Neighbour, kMaxNeighbours + 1> found;
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                              const std::span<Neighbour> result(found.data(), k + 1);
                              tree.nearest(positions[finite[i]], result);
                              float sum = 0.0f;
                              std::uint32_t taken = 0;
                              for (const Neighbour& n : result) {
                                  if (n.index == finite[i] || taken == k)
                                      continue;  // the point finds itself
                                  if (neighbours != nullptr) (*neighbours)[i * k + taken] = n.index;
                                  sum += std::sqrt(n.squared_distance);
                                  ++taken;
                              }
                              mean[finite[i]] = sum / static_cast<float>(k);
                          }
                      });
    return mean;
}

}  // namespace

std::vector<std::uint32_t> thin_indices(std::span<const Vec3f> positions, double voxel_size) {
    if (!(voxel_size > 0.0)) {
        throw Error(ExitCode::kUsage,
                    "the thinning voxel size must be a positive length in metres");
    }
    const std::vector<std::uint32_t> finite = finite_indices(positions);
    if (finite.empty()) return {};

    Vec3f low = positions[finite[0]], high = low;
    for (const std::uint32_t i : finite) {
        low = component_min(low, positions[i]);
        high = component_max(high, positions[i]);
    }
    const Vec3d extent = vec3_cast<double>(high) - vec3_cast<double>(low);
    const double longest = std::max({extent.x, extent.y, extent.z});
    if (longest / voxel_size >= static_cast<double>(kMaxCells)) {
        throw Error(ExitCode::kUsage,
                    "the thinning voxel size is too small for the cloud's extent of " +
                        std::to_string(longest) + " m; use at least " +
                        std::to_string(longest / static_cast<double>(kMaxCells - 1)) + " m");
    }

    // Cells are anchored at multiples of the voxel size, so that the result does not hang on one
    // stray point at the cloud's corner.
    const auto cell_of = [&](float coordinate, float lowest) {
        return static_cast<std::uint64_t>(std::floor(static_cast<double>(coordinate) / voxel_size) -
                                          std::floor(static_cast<double>(lowest) / voxel_size));
    };
    std::vector<CellPoint> sorted(finite.size());
    tbb::parallel_for(std::size_t{0}, finite.size(), [&](std::size_t i) {
        const Vec3f& p = positions[finite[i]];
        const std::uint64_t cell =
            cell_of(p.z, low.z) << 42 | cell_of(p.y, low.y) << 21 | cell_of(p.x, low.x);
        sorted[i] = {cell, finite[i]};
    });
    tbb::parallel_sort(sorted.begin(), sorted.end());

    std::vector<std::uint32_t> kept;
    for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
        Vec3d mean;
        for (end = begin; end < sorted.size() && sorted[end].cell == sorted[begin].cell; ++end) {
            mean += vec3_cast<double>(positions[sorted[end].index]);
        }
        mean = mean / static_cast<double>(end - begin);
        double best = std::numeric_limits<double>::infinity();
        std::uint32_t nearest = sorted[begin].index;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d d = vec3_cast<double>(positions[sorted[i].index]) - mean;
            if (dot(d, d) < best) {
                best = dot(d, d);
                nearest = sorted[i].index;
            }
        }
        kept.push_back(nearest);
    }
    std::sort(kept.begin(), kept.end());
    return kept;
}

Points thin(const Points& points, double voxel_size) {
    return points.select(thin_indices(points.positions, voxel_size));
}

std::vector<std::uint32_t> inlier_indices(std::span<const Vec3f> positions, bool has_viewpoint,
                                          const OutlierSettings& settings) {
    const std::uint32_t k = settings.neighbours;
    if (k < 2 || k > kMaxNeighbours || !(settings.factor > 1.0) || !(settings.ray_factor > 1.0)) {
        throw Error(ExitCode::kUsage,
                    "outlier removal needs 2 to 64 neighbours and factors above 1");
    }
    std::vector<std::uint32_t> finite = finite_indices(positions);
    if (finite.size() <= k) return finite;

    std::vector<std::uint32_t> neighbours;
    const std::vector<float> loneliness = mean_distances(positions, finite, k, &neighbours);
    std::vector<float> ray_spacing;
    if (has_viewpoint) {
        std::vector<Vec3f> directions(positions.begin(), positions.end());
        for (Vec3f& d : directions)
            d = normalized(d);
        ray_spacing = mean_distances(directions, finite, k, nullptr);
    }

    std::vector<std::uint8_t> keep(finite.size());
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, finite.size(), 512), [&](const auto& range) {
            std::array<float, kMaxNeighbours> others;
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                for (std::uint32_t j = 0; j < k; ++j)
                    others[j] = loneliness[neighbours[i * k + j]];
                const auto middle = others.begin() + k / 2;
                std::nth_element(others.begin(), middle, others.begin() + k);
                const double alone = static_cast<double>(loneliness[finite[i]]);
                keep[i] = alone <= settings.factor * static_cast<double>(*middle);
                if (!has_viewpoint) continue;
                const float rays_apart = ray_spacing[finite[i]] * length(positions[finite[i]]);
                keep[i] = keep[i] && alone <= settings.ray_factor * static_cast<double>(rays_apart);
            }
        });

    std::vector<std::uint32_t> inliers;
    inliers.reserve(finite.size());
    for (std::size_t i = 0; i < finite.size(); ++i) {
        if (keep[i]) inliers.push_back(finite[i]);
    }
    return inliers;
}

Points clean(const Points& points, bool has_viewpoint, const CleanSettings& settings,
             CleanReport* report) {
    CleanReport counted{.points_in = points.size()};
    Points result =
        points.select(settings.remove_outliers
                          ? inlier_indices(points.positions, has_viewpoint, settings.outliers)
                          : finite_indices(points.positions));
    counted.outliers = points.size() - result.size();
    if (settings.voxel_size > 0.0) {
        const std::size_t before = result.size();
        result = thin(result, settings.voxel_size);
        counted.thinned = before - result.size();
    }
    if (report != nullptr) *report = counted;
    return result;
}

}  // namespace glowworm

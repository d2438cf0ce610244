#include "preprocess/surface/normals.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "preprocess/surface/plane_fit.h"

namespace glowworm {
namespace {

/// A station whose view lies this little behind the plane (cosine) may still have seen its front:
/// the plane is not exact.
constexpr float kGrazing = -0.1f;

/// Fewer neighbours of the own station than this tell nothing about its surface.
constexpr std::size_t kOwnStationEnough = 5;

/// Fits planes to neighbourhoods. A thread keeps one and reuses its memory.
class NeighbourhoodFit {
  public:
    explicit NeighbourhoodFit(const SurfacePoints& points) : points_(&points) {}

    /// The plane through point i and the `neighbours` on its side; centre relative to the point.
    PlaneFit fit(std::size_t i, std::span<const std::uint32_t> neighbours) {
        const Vec3f origin = points_->tree.position(i);
        Moments own, all;
        own.add({});
        all.add({});
        offsets_.clear();
        std::size_t others = 0;
        for (const std::uint32_t j : neighbours) {
            const Vec3d offset = vec3_cast<double>(points_->tree.position(j) - origin);
            offsets_.push_back(offset);
            all.add(offset);
            if (points_->station(j) == points_->station(i)) {
                own.add(offset);
            } else {
                ++others;
            }
        }
        if (others == 0 || !points_->is_viewed(i)) return fit_plane(all);

        // What the own station saw is on one side; the others' points join if seen from there too.
        const bool enough = neighbours.size() - others >= kOwnStationEnough;
        PlaneFit side = fit_plane(enough ? own : all);
        if (enough && !side.is_planar()) side = fit_plane(all);
        const Vec3d view = vec3_cast<double>(points_->toward_station(i));
        const Vec3d normal = dot(side.normal, view) < 0.0 ? -side.normal : side.normal;
        Moments front;
        front.add({});
        for (std::size_t m = 0; m < neighbours.size(); ++m) {
            if (is_in_front(i, neighbours[m], normal)) front.add(offsets_[m]);
        }
        return fit_plane(front);
    }

  private:
    bool is_in_front(std::size_t i, std::size_t j, const Vec3d& normal) const {
        if (points_->station(j) == points_->station(i) || !points_->is_viewed(j)) return true;
        const Vec3d view = vec3_cast<double>(points_->toward_station(j));
        return dot(normal, view) > kGrazing * length(view);
    }

    const SurfacePoints* points_;
    std::vector<Vec3d> offsets_;
};

LocalPlane to_local_plane(const PlaneFit& fit) {
    const double n = fit.weight;
    LocalPlane plane;
    plane.points = static_cast<std::uint16_t>(n);
    if (!fit.is_planar()) return plane;
    plane.normal = vec3_cast<float>(fit.normal);
    plane.height = static_cast<float>(dot(fit.normal, fit.centre));
    plane.thickness = static_cast<float>(std::sqrt(fit.thickness2 * n / std::max(n - 3.0, 1.0)));
    plane.error_per_noise = static_cast<float>(fit.angle_error_per_noise());
    plane.area = static_cast<float>(area_per_point(fit));
    return plane;
}

/// A fit to more points, in place of one to fewer: where the fewer determined no plane, and where
/// the more are as thin as noise alone makes them.
bool is_better(const LocalPlane& more, const LocalPlane& fewer, float noise) {
    if (more.area == 0.0f) return false;
    return fewer.area == 0.0f || more.thickness < 1.5f * noise;
}

}  // namespace

double area_per_point(const PlaneFit& fit) {
    const double n = fit.weight;
    return fit.area() * (n + 1.5) / ((n - 1.0) * (n - 1.0));
}

std::vector<LocalPlane> fit_local_planes(const SurfacePoints& points,
                                         const NormalSettings& settings, NeighbourTable& table,
                                         const Progress& progress) {
    const PointTree& tree = points.tree;
    const auto stride = static_cast<std::size_t>(table.count);
    table.rows.assign(tree.size() * stride, kNoNeighbour);
    std::vector<LocalPlane> planes(tree.size());
    const auto fit_leaf = [&](const PointTree::Node& leaf, NearestSearch& search,
                              NeighbourhoodFit& fit, std::vector<std::uint32_t>& queries) {
        queries.resize(leaf.count);
        std::iota(queries.begin(), queries.end(), leaf.first);
        for (int size = settings.k;; size = std::min(2 * size, settings.max_k)) {
            search.search(queries, size - 1, settings.radius);
            std::size_t unsettled = 0;
            for (std::size_t q = 0; q < queries.size(); ++q) {
                const std::uint32_t i = queries[q];
                const auto found = search.found(q);
                if (size == settings.k) {
                    std::ranges::copy(found.first(std::min(found.size(), stride)),
                                      table.rows.begin() + static_cast<std::ptrdiff_t>(i * stride));
                }
                const LocalPlane plane = to_local_plane(fit.fit(i, found));
                const bool accepted =
                    size == settings.k || is_better(plane, planes[i], settings.range_noise);
                if (accepted) planes[i] = plane;
                const bool settled = plane.area > 0.0f &&
                                     (!accepted || plane.error_per_noise * settings.range_noise <=
                                                       settings.slope_error);
                const bool exhausted = found.size() + 1 < static_cast<std::size_t>(size);
                if (!settled && !exhausted) queries[unsettled++] = i;
            }
            queries.resize(unsettled);
            if (queries.empty() || size == settings.max_k) return;
        }
    };

    const std::size_t block = std::max<std::size_t>(tree.leaves.size() / 64, 1024);
    for (std::size_t begin = 0; begin < tree.leaves.size(); begin += block) {
        const std::size_t end = std::min(begin + block, tree.leaves.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, 64), [&](const auto& range) {
            NearestSearch search(tree);
            NeighbourhoodFit fit(points);
            std::vector<std::uint32_t> queries;
            for (std::size_t l = range.begin(); l < range.end(); ++l) {
                fit_leaf(tree.nodes[tree.leaves[l]], search, fit, queries);
            }
        });
        if (progress) {
            const PointTree::Node& last = tree.nodes[tree.leaves[end - 1]];
            progress(last.first + last.count, tree.size());
        }
    }
    return planes;
}

}  // namespace glowworm

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

/// A neighbourhood this much thicker than the noise is bent: it must not grow.
constexpr float kNoiseAlone = 1.5f;

/// Variances across and along a neighbourhood in this ratio belong to a scan line.
constexpr double kSlender = 0.04;

/// The plane, of zero area where nothing determines one.
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

/// Fits planes leaf by leaf. A thread keeps one and reuses its memory.
class LeafFit {
  public:
    LeafFit(const SurfacePoints& points, const NormalSettings& settings, NeighbourTable& table,
            std::vector<LocalPlane>& planes)
        : points_(points),
          settings_(settings),
          table_(table),
          planes_(planes),
          search_(points.tree) {}

    void fit(const PointTree::Node& leaf) {
        fit_nearest(leaf);
        grow_noisy();
        widen_odd();
    }

  private:
    /// Fits to the k nearest and sorts out who needs more.
    void fit_nearest(const PointTree::Node& leaf) {
        queries_.resize(leaf.count);
        std::iota(queries_.begin(), queries_.end(), leaf.first);
        noisy_.clear();
        odd_.clear();
        search_.gather(queries_, settings_.k - 1, settings_.radius);
        const auto stride = static_cast<std::size_t>(table_.count);
        for (const std::uint32_t i : queries_) {
            search_.measure(i);
            const auto found = search_.nearest(settings_.k - 1);
            const PlaneFit plane = fit_side(i, found);
            planes_[i] = to_local_plane(plane);
            const bool more_are_there = found.size() + 1 == static_cast<std::size_t>(settings_.k);
            std::ranges::copy(search_.nearest_of_those(table_.count),
                              table_.rows.begin() + static_cast<std::ptrdiff_t>(i * stride));
            if (!more_are_there) continue;
            if (!is_well_shaped(plane)) {
                odd_.push_back(i);
            } else if (is_noisy(planes_[i])) {
                noisy_.push_back(i);
            }
        }
    }

    /// Widens the neighbourhoods whose normal the noise turns, as long as they are as thin as noise
    /// alone makes them. Extent and number grow together, so the error falls as one over the
    /// number: those that need the most get it at once, and half of it where that is bent. The area
    /// stays that of the nearest: the last of a neighbourhood that was chosen for being wide lies
    /// farther than chance has it.
    void grow_noisy() {
        for (int size = 2 * settings_.k; size <= settings_.max_k; size *= 2) {
            const bool is_last = 2 * size > settings_.max_k;
            wanting_.clear();
            std::erase_if(noisy_, [&](std::uint32_t i) {
                const float error = planes_[i].error_per_noise * settings_.range_noise;
                const float needed =
                    error / settings_.slope_error * static_cast<float>(planes_[i].points);
                if (!is_last && needed > static_cast<float>(size)) return false;
                wanting_.push_back(i);
                return true;
            });
            if (wanting_.empty()) continue;
            search_.gather(wanting_, size - 1, settings_.radius);
            for (const std::uint32_t i : wanting_)
                grow(i, size);
        }
    }

    void grow(std::uint32_t i, int size) {
        search_.measure(i);
        auto found = search_.nearest(size - 1);
        for (; size > settings_.k; size /= 2) {
            LocalPlane plane = to_local_plane(fit_side(i, found));
            if (plane.area > 0.0f && plane.thickness <= kNoiseAlone * settings_.range_noise) {
                plane.area = planes_[i].area;
                planes_[i] = plane;
                return;
            }
            found = search_.nearest_of_those(size / 2 - 1);
        }
    }

    /// A stretch of one scan line needs its neighbour lines before it says anything.
    void widen_odd() {
        if (odd_.empty()) return;
        const int most = settings_.max_k - 1;
        search_.gather(odd_, most, settings_.radius);
        for (const std::uint32_t i : odd_) {
            search_.measure(i);
            const LocalPlane plane = to_local_plane(fit_side(i, search_.nearest(most)));
            if (plane.area > 0.0f) planes_[i] = plane;
        }
    }

    bool is_noisy(const LocalPlane& plane) const {
        return plane.error_per_noise * settings_.range_noise > settings_.slope_error;
    }

    /// Wide in both directions, and by more than noise could make it.
    bool is_well_shaped(const PlaneFit& fit) const {
        const double noise = settings_.range_noise;
        return fit.is_planar() && fit.width2 > kSlender * fit.length2 &&
               fit.width2 > 4.0 * noise * noise;
    }

    /// The plane through point i and those of `neighbours` that are on its side; its centre is
    /// relative to the point.
    PlaneFit fit_side(std::size_t i, std::span<const std::uint32_t> neighbours) {
        const Vec3f origin = points_.tree.position(i);
        const std::uint32_t station = points_.view(i);
        Moments all;
        all.add({});
        offsets_.clear();
        for (const std::uint32_t j : neighbours) {
            offsets_.push_back(vec3_cast<double>(points_.tree.position(j) - origin));
            all.add(offsets_.back());
        }
        const auto others = static_cast<std::size_t>(std::ranges::count_if(
            neighbours, [&](std::uint32_t j) { return points_.view(j) != station; }));
        if (others == 0 || !points_.is_viewed(i)) return fit_plane(all);

        // What the own station saw is on one side; the others' points join if seen from there too.
        const bool enough = neighbours.size() - others >= kOwnStationEnough;
        PlaneFit side = fit_plane(all);
        if (enough) {
            Moments own;
            own.add({});
            for (std::size_t m = 0; m < neighbours.size(); ++m) {
                if (points_.view(neighbours[m]) == station) own.add(offsets_[m]);
            }
            const PlaneFit alone = fit_plane(own);
            if (alone.is_planar()) side = alone;
        }
        const Vec3d view = vec3_cast<double>(points_.toward_viewpoint(i));
        const Vec3d normal = dot(side.normal, view) < 0.0 ? -side.normal : side.normal;
        Moments front;
        front.add({});
        for (std::size_t m = 0; m < neighbours.size(); ++m) {
            if (is_in_front(i, neighbours[m], normal)) front.add(offsets_[m]);
        }
        return fit_plane(front);
    }

    bool is_in_front(std::size_t i, std::size_t j, const Vec3d& normal) const {
        if (points_.view(j) == points_.view(i) || !points_.is_viewed(j)) return true;
        const Vec3d view = vec3_cast<double>(points_.toward_viewpoint(j));
        return dot(normal, view) > kGrazing * length(view);
    }

    const SurfacePoints& points_;
    const NormalSettings& settings_;
    NeighbourTable& table_;
    std::vector<LocalPlane>& planes_;
    NearestSearch search_;
    std::vector<std::uint32_t> queries_, noisy_, wanting_, odd_;
    std::vector<Vec3d> offsets_;
};

}  // namespace

double area_per_point(const PlaneFit& fit) {
    const double n = fit.weight;
    return fit.area() * (n + 0.8) / ((n - 1.0) * (n - 1.0));
}

std::vector<LocalPlane> fit_local_planes(const SurfacePoints& points,
                                         const NormalSettings& settings, NeighbourTable& table,
                                         const Progress& progress) {
    const PointTree& tree = points.tree;
    table.rows.assign(tree.size() * static_cast<std::size_t>(table.count), kNoNeighbour);
    std::vector<LocalPlane> planes(tree.size());
    const std::size_t block = std::max<std::size_t>(tree.leaves.size() / 64, 1024);
    for (std::size_t begin = 0; begin < tree.leaves.size(); begin += block) {
        const std::size_t end = std::min(begin + block, tree.leaves.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, 64), [&](const auto& range) {
            LeafFit leaf_fit(points, settings, table, planes);
            for (std::size_t l = range.begin(); l < range.end(); ++l) {
                leaf_fit.fit(tree.nodes[tree.leaves[l]]);
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

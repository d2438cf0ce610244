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
          search_(points.tree),
          ahead_(settings.k),
          views_(points.seen_from.empty() ? points.stations : points.seen_from) {}

    /// Fits to the k nearest, then again to more where those do not determine the normal. Leaves
    /// resemble the one before: as many as most of its points took are found at once.
    void fit(const PointTree::Node& leaf) {
        queries_.resize(leaf.count);
        std::iota(queries_.begin(), queries_.end(), leaf.first);
        wanting_.clear();
        odd_.clear();
        grown_ = 0;
        search_.visit_nearest(queries_, ahead_ - 1, settings_.radius,
                              [&](std::uint32_t i, const Neighbours& near) { fit(i, near); });
        for (int size = 2 * settings_.k; !wanting_.empty() && size <= settings_.max_k; size *= 2)
            grow_wanting(size);
        widen_odd();
        if (4 * grown_ < leaf.count) {
            ahead_ = settings_.k;
        } else if (4 * grown_ > 3 * leaf.count && 2 * settings_.k <= settings_.max_k) {
            ahead_ = 2 * settings_.k;
        }
    }

  private:
    struct Wanting {
        std::uint32_t point;
        int size;
    };

    /// Fits to the k nearest and sorts out who needs more.
    void fit(std::uint32_t i, const Neighbours& near) {
        const auto others = static_cast<std::size_t>(settings_.k) - 1;
        const Neighbours nearest = near.first(others);
        const PlaneFit plane = fit_side(i, nearest);
        planes_[i] = to_local_plane(plane);
        const auto stride = static_cast<std::size_t>(table_.count);
        std::ranges::copy(nearest.first(stride).index,
                          table_.rows.begin() + static_cast<std::ptrdiff_t>(i * stride));
        if (nearest.size() < others) return;
        if (!is_well_shaped(plane)) {
            odd_.push_back(i);
        } else if (is_noisy(planes_[i]) && 2 * settings_.k <= settings_.max_k) {
            const int size = size_for(planes_[i]);
            ++grown_;
            if (size <= ahead_) {
                grow(i, size, near);
            } else {
                wanting_.push_back({i, size});
            }
        }
    }

    /// How many points make the noise turn the normal by little enough: k times a power of two,
    /// max_k at most. Extent and number grow together, so the error falls as one over the number.
    int size_for(const LocalPlane& plane) const {
        const float error = plane.error_per_noise * settings_.range_noise;
        const float needed = error / settings_.slope_error * static_cast<float>(plane.points);
        int size = 2 * settings_.k;
        while (2 * size <= settings_.max_k && needed > static_cast<float>(size))
            size *= 2;
        return size;
    }

    void grow_wanting(int size) {
        queries_.clear();
        std::erase_if(wanting_, [&](const Wanting& wanting) {
            if (wanting.size == size) queries_.push_back(wanting.point);
            return wanting.size == size;
        });
        search_.visit_nearest(
            queries_, size - 1, settings_.radius,
            [&](std::uint32_t i, const Neighbours& near) { grow(i, size, near); });
    }

    /// Widens a neighbourhood as long as it is as thin as noise alone makes it: `size`, or half of
    /// it where that is bent. The area stays that of the nearest: the last of a neighbourhood that
    /// was chosen for being wide lies farther than chance has it.
    void grow(std::uint32_t i, int size, const Neighbours& near) {
        for (; size > settings_.k; size /= 2) {
            const Neighbours found = near.first(static_cast<std::size_t>(size) - 1);
            LocalPlane plane = to_local_plane(fit_side(i, found));
            if (plane.area > 0.0f && plane.thickness <= kNoiseAlone * settings_.range_noise) {
                plane.area = planes_[i].area;
                planes_[i] = plane;
                return;
            }
        }
    }

    /// A stretch of one scan line needs its neighbour lines before it says anything.
    void widen_odd() {
        search_.visit_nearest(odd_, settings_.max_k - 1, settings_.radius,
                              [&](std::uint32_t i, const Neighbours& near) {
                                  const LocalPlane plane = to_local_plane(fit_side(i, near));
                                  if (plane.area > 0.0f) planes_[i] = plane;
                              });
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

    /// The plane through point i and those of its neighbours that are on its side; its centre is
    /// relative to the point.
    PlaneFit fit_side(std::uint32_t i, const Neighbours& near) {
        const std::size_t size = near.size() + 1;
        const PlaneFit all = fit_plane(moments_of(near.x, near.y, near.z, size));
        if (views_.empty() || !points_.is_viewed(i)) return all;
        const std::uint32_t view = views_[i];
        std::size_t others = 0;
        for (const std::uint32_t j : near.index)
            others += views_[j] != view;
        if (others == 0) return all;

        // What the own station saw is on one side; the others' points join if seen from there too.
        PlaneFit side = all;
        if (near.size() - others >= kOwnStationEnough) {
            const PlaneFit alone =
                fit_some(near, [&](std::uint32_t j) { return views_[j] == view; });
            if (alone.is_planar()) side = alone;
        }
        const Vec3d toward = vec3_cast<double>(points_.toward_viewpoint(i));
        const Vec3d normal = dot(side.normal, toward) < 0.0 ? -side.normal : side.normal;
        return fit_some(near, [&](std::uint32_t j) { return is_in_front(i, j, normal); });
    }

    /// The plane through the point itself and those of its neighbours that `take` takes.
    template <typename Take>
    PlaneFit fit_some(const Neighbours& near, const Take& take) {
        Moments some;
        some.add({});
        for (std::size_t n = 0; n < near.size(); ++n) {
            if (take(near.index[n])) some.add({near.x[n + 1], near.y[n + 1], near.z[n + 1]});
        }
        return fit_plane(some);
    }

    bool is_in_front(std::uint32_t i, std::uint32_t j, const Vec3d& normal) const {
        if (views_[j] == views_[i] || !points_.is_viewed(j)) return true;
        const Vec3d view = vec3_cast<double>(points_.toward_viewpoint(j));
        return dot(normal, view) > kGrazing * length(view);
    }

    const SurfacePoints& points_;
    const NormalSettings& settings_;
    NeighbourTable& table_;
    std::vector<LocalPlane>& planes_;
    NearestSearch search_;
    int ahead_;                // points found for each of a leaf at first
    std::uint32_t grown_ = 0;  // points of the leaf that needed more than k
    std::vector<std::uint32_t> queries_, odd_;
    std::vector<Wanting> wanting_;
    std::span<const std::uint32_t>
        views_;  // where each point was seen from; empty: all from one place
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

#include "preprocess/surface/range_noise.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "preprocess/surface/neighbours.h"
#include "preprocess/surface/plane_fit.h"

namespace glowworm {
namespace {

constexpr std::size_t kSample = 8192;

/// Points that leave a quadric some freedom to be judged by, and times as many as a second opinion:
/// where the fewer lie on one scan line, noise passes for their width and leaves no residual.
constexpr int kFewest = 16;
constexpr int kSecondOpinion = 4;

/// Parameters of a quadric over a plane: 1, u, v, u², uv, v².
constexpr int kTerms = 6;

/// rms distance, with kTerms degrees of freedom taken out, of the points from the quadric fitted to
/// them, m; negative where it is not determined.
double quadric_residual(const Neighbours& near, const PlaneFit& plane) {
    const double count = static_cast<double>(near.size()) + 1.0;
    if (!plane.is_planar() || count < 2 * kTerms) return -1.0;

    const Vec3d axis = std::abs(plane.normal.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const double scale = 1.0 / std::sqrt(plane.length2);
    const Vec3d u = normalized(cross(plane.normal, axis)) * scale;
    const Vec3d v = cross(plane.normal, u);

    // Normal equations with the heights as a seventh column: Cholesky's last pivot is then the sum
    // of squared residuals.
    double a[kTerms + 1][kTerms + 1] = {};
    for (std::size_t i = 0; i <= near.size(); ++i) {
        const Vec3d q = Vec3d{near.x[i], near.y[i], near.z[i]} - plane.centre;
        const double s = dot(u, q), t = dot(v, q);
        const double row[kTerms + 1] = {1.0, s, t, s * s, s * t, t * t, dot(plane.normal, q)};
        for (int r = 0; r <= kTerms; ++r) {
            for (int c = 0; c <= r; ++c)
                a[r][c] += row[r] * row[c];
        }
    }
    for (int c = 0; c < kTerms; ++c) {
        if (!(a[c][c] > 1e-9 * count)) return -1.0;
        for (int r = c + 1; r <= kTerms; ++r) {
            const double factor = a[r][c] / a[c][c];
            for (int d = c + 1; d <= r; ++d)
                a[r][d] -= factor * a[d][c];
        }
    }
    return std::sqrt(std::max(a[kTerms][kTerms], 0.0) / (count - kTerms));
}

PlaneFit plane_of(const Neighbours& near) {
    return fit_plane(moments_of(near.x, near.y, near.z, near.size() + 1));
}

double residual(const Neighbours& few, const Neighbours& many) {
    const PlaneFit wide = plane_of(many), close = plane_of(few);
    const bool agree =
        close.width2 > 0.05 * close.length2 && std::abs(dot(wide.normal, close.normal)) > 0.8;
    return agree ? quadric_residual(few, close) : quadric_residual(many, wide);
}

float distance_of_last(const Neighbours& near) {
    const std::size_t last = near.size();
    return length(Vec3f{near.x[last], near.y[last], near.z[last]});
}

/// The value below which `share` of `values` lie; 0 where there are none.
double quantile(std::vector<double>& values, double share) {
    if (values.empty()) return 0.0;
    const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return values[static_cast<std::size_t>(rank)];
}

/// Lower quartile of sqrt(chi² / dof), by Wilson and Hilferty's cube root.
double chi_lower_quartile(double dof) {
    const double z = -0.67449;
    const double spread = 2.0 / (9.0 * dof);
    const double root = 1.0 - spread + z * std::sqrt(spread);
    return std::sqrt(root * root * root);
}

}  // namespace

CloudScale measure_scale(const PointTree& tree, int k) {
    CloudScale scale;
    if (tree.size() < 2) return scale;
    k = std::max(k, kFewest);
    const std::size_t sample = std::min(tree.size(), kSample);
    std::vector<double> distances(sample), residuals(sample);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sample, 64), [&](const auto& range) {
        NearestSearch search(tree);
        for (std::size_t s = range.begin(); s < range.end(); ++s) {
            const auto i = static_cast<std::uint32_t>(s * tree.size() / sample);
            search.visit_nearest({&i, 1}, kSecondOpinion * k - 1, kFarthest,
                                 [&](std::uint32_t, const Neighbours& many) {
                                     const Neighbours few =
                                         many.first(static_cast<std::size_t>(k) - 1);
                                     distances[s] = distance_of_last(few);
                                     residuals[s] = residual(few, many);
                                 });
        }
    });
    std::erase_if(residuals, [](double r) { return r < 0.0; });
    scale.reach = static_cast<float>(quantile(distances, 0.95));
    scale.range_noise =
        static_cast<float>(quantile(residuals, 0.25) / chi_lower_quartile(std::max(k - kTerms, 1)));
    return scale;
}

}  // namespace glowworm

#include "octree/cloud_summary.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace glowworm {
namespace {

constexpr std::size_t kGrain = 16384;
constexpr std::size_t kMostRadii = 65536;

bool has_radius(const Surfel& s) {
    return s.radius > 0.0f && std::isfinite(s.radius);
}

bool in_range(const Surfel& s) {
    const auto unit_interval = [](float v) { return v >= 0.0f && v <= 1.0f; };
    return std::abs(dot(s.normal, s.normal) - 1.0f) < 1e-3f && has_radius(s) &&
           s.ndf_length > 0.0f && s.ndf_length <= 1.0f && unit_interval(s.albedo.x) &&
           unit_interval(s.albedo.y) && unit_interval(s.albedo.z) && s.emission.x >= 0.0f &&
           s.emission.y >= 0.0f && s.emission.z >= 0.0f;
}

CloudSummary joined(CloudSummary a, const CloudSummary& b) {
    if (b.usable > 0) {
        a.bounds_min = a.usable > 0 ? component_min(a.bounds_min, b.bounds_min) : b.bounds_min;
        a.bounds_max = a.usable > 0 ? component_max(a.bounds_max, b.bounds_max) : b.bounds_max;
    }
    a.usable += b.usable;
    a.dropped += b.dropped;
    a.needs_repair |= b.needs_repair;
    a.radius_missing |= b.radius_missing;
    return a;
}

CloudSummary one(const Surfel& s) {
    CloudSummary sum;
    sum.dropped = is_usable(s) ? 0 : 1;
    if (sum.dropped > 0) return sum;
    sum.usable = 1;
    sum.bounds_min = sum.bounds_max = s.position;
    sum.needs_repair = !in_range(s);
    sum.radius_missing = !has_radius(s);
    return sum;
}

}  // namespace

double CloudSummary::median_spacing() const {
    return median_radius / std::numbers::inv_sqrtpi;
}

bool is_usable(const Surfel& s) {
    const float squared = dot(s.normal, s.normal);
    return is_finite(s.position) && std::isfinite(squared) && squared > 1e-12f &&
           is_finite(s.albedo) && is_finite(s.emission) && std::isfinite(s.ndf_length) &&
           !std::isnan(s.radius);
}

void repair(Surfel& s, double default_radius) {
    const auto unit_interval = [](float v) { return std::clamp(v, 0.0f, 1.0f); };
    s.normal = normalized(s.normal);
    if (!has_radius(s)) s.radius = static_cast<float>(default_radius);
    s.ndf_length = std::clamp(s.ndf_length, 1.0f / 255.0f, 1.0f);
    s.albedo = {unit_interval(s.albedo.x), unit_interval(s.albedo.y), unit_interval(s.albedo.z)};
    s.emission = component_max(s.emission, Vec3f{});
}

void CloudSummarizer::add(std::span<const Surfel> batch) {
    sum_ =
        joined(sum_, tbb::parallel_reduce(
                         tbb::blocked_range<std::size_t>(0, batch.size(), kGrain), CloudSummary{},
                         [&](const auto& range, CloudSummary sum) {
                             for (std::size_t i = range.begin(); i != range.end(); ++i) {
                                 sum = joined(sum, one(batch[i]));
                             }
                             return sum;
                         },
                         joined));

    for (std::uint64_t next = (seen_ + stride_ - 1) / stride_ * stride_;
         next < seen_ + batch.size(); next += stride_) {
        const Surfel& s = batch[next - seen_];
        radii_.push_back(is_usable(s) && has_radius(s) ? s.radius
                                                       : std::numeric_limits<float>::quiet_NaN());
        if (radii_.size() <= kMostRadii) continue;
        // An odd number: the first, the last and every second between stay.
        for (std::size_t i = 0; 2 * i < radii_.size(); ++i)
            radii_[i] = radii_[2 * i];
        radii_.resize(radii_.size() / 2 + 1);
        stride_ *= 2;
    }
    seen_ += batch.size();
}

CloudSummary CloudSummarizer::finish() const {
    CloudSummary summary = sum_;
    std::vector<float>& radii = summary.radii;
    radii = radii_;
    std::erase_if(radii, [](float r) { return std::isnan(r); });
    if (!radii.empty()) {
        const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
        std::nth_element(radii.begin(), middle, radii.end());
        summary.median_radius = *middle;
    }
    return summary;
}

CloudSummary summarize(std::span<const Surfel> surfels) {
    CloudSummarizer summarizer;
    summarizer.add(surfels);
    return summarizer.finish();
}

}  // namespace glowworm

#include "preprocess/depth_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glowworm {
namespace {

constexpr std::uint32_t kCoarsest = 8, kFinest = 360;  // cells per face edge: 11° to 0.25°

std::uint32_t resolution_for(std::size_t points, double points_per_cell) {
    const double cells = static_cast<double>(points) / std::max(points_per_cell, 0.1);
    const double edge = std::sqrt(cells / 6.0);
    return static_cast<std::uint32_t>(
        std::clamp(edge, static_cast<double>(kCoarsest), static_cast<double>(kFinest)));
}

}  // namespace

std::uint32_t CubeMap::cell(const Vec3f& d) const {
    const float ax = std::abs(d.x), ay = std::abs(d.y), az = std::abs(d.z);
    std::uint32_t face;
    float u, v, longest;
    if (ax >= ay && ax >= az) {
        face = d.x < 0 ? 1 : 0, longest = ax, u = d.y, v = d.z;
    } else if (ay >= az) {
        face = d.y < 0 ? 3 : 2, longest = ay, u = d.x, v = d.z;
    } else {
        face = d.z < 0 ? 5 : 4, longest = az, u = d.x, v = d.y;
    }
    const auto index = [&](float t) {
        const float scaled = (t / longest + 1.0f) * 0.5f * static_cast<float>(resolution);
        return std::min(static_cast<std::uint32_t>(std::max(scaled, 0.0f)), resolution - 1);
    };
    return (face * resolution + index(v)) * resolution + index(u);
}

DepthImage::DepthImage(std::span<const Vec3f> positions, double points_per_cell)
    : map_(resolution_for(positions.size(), points_per_cell)) {
    const Depths empty{std::numeric_limits<float>::infinity(), 0.0f};
    own_.assign(map_.size(), empty);
    for (const Vec3f& p : positions) {
        const float depth = length(p);
        if (!std::isfinite(depth) || depth <= 0.0f) continue;
        Depths& cell = own_[map_.cell(p)];
        cell.nearest = std::min(cell.nearest, depth);
        cell.farthest = std::max(cell.farthest, depth);
    }
    around_.assign(map_.size(), empty);
    for (std::uint32_t cell = 0; cell < map_.size(); ++cell) {
        map_.for_ring(cell, [&](std::uint32_t other) {
            around_[cell].nearest = std::min(around_[cell].nearest, own_[other].nearest);
            around_[cell].farthest = std::max(around_[cell].farthest, own_[other].farthest);
        });
    }
}

Seen DepthImage::at(const Vec3f& place, float margin) const {
    const float depth = length(place);
    if (!std::isfinite(depth) || depth <= 0.0f) return Seen::kUnknown;
    const std::uint32_t cell = map_.cell(place);
    if (own_[cell].nearest > own_[cell].farthest) return Seen::kUnknown;
    if (depth < around_[cell].nearest - margin) return Seen::kFree;
    if (depth > around_[cell].farthest + margin) return Seen::kHidden;
    return Seen::kSurface;
}

double DepthImage::cell_width() const {
    return 1.5707963267948966 / static_cast<double>(map_.resolution);
}

}  // namespace glowworm

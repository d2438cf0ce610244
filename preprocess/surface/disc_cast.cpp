#include "preprocess/surface/disc_cast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace glowworm {
namespace {

/// Radius of a disc over that of the circle with the point's area. Points at random that cover
/// their area once leave 37 % of it open, with discs of four times the area 2 %.
constexpr float kOverlap = 2.0f;

/// Radii that rays skip along the surface they leave.
constexpr float kSkipRadii = 1.5f;

float radius_of(const LocalPlane& plane) {
    return std::sqrt(plane.area / std::numbers::pi_v<float>);
}

}  // namespace

DiscCast::DiscCast(const SurfacePoints& points, const std::vector<LocalPlane>& planes)
    : points_(points), planes_(planes), widest_(points.tree.nodes.size(), 0.0f) {
    const auto& nodes = points.tree.nodes;
    for (std::size_t n = nodes.size(); n-- > 0;) {
        const PointTree::Node& node = nodes[n];
        for (std::uint32_t c = node.first_child; c < node.first_child + node.children; ++c)
            widest_[n] = std::max(widest_[n], widest_[c]);
        if (node.children > 0) continue;
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const float reach = kOverlap * radius_of(planes[i]) + std::abs(planes[i].height);
            widest_[n] = std::max(widest_[n], reach);
        }
    }
}

float DiscCast::clearance(std::size_t i, float cosine) const {
    const LocalPlane& plane = planes_[i];
    return kSkipRadii * radius_of(plane) + 4.0f * plane.thickness / std::max(cosine, 0.2f);
}

DiscCast::Hit DiscCast::first(const Vec3f& from, const Vec3f& direction, float nearest,
                              float farthest) const {
    Hit hit{kNoNeighbour, farthest};
    const auto inverse = [](float d) {
        return std::abs(d) > 1e-12f ? 1.0f / d : std::copysign(1e12f, d);
    };
    const Vec3f slope{inverse(direction.x), inverse(direction.y), inverse(direction.z)};
    // Where the ray enters a node's box, grown by its largest disc; infinite where it passes by.
    const auto entry = [&](std::uint32_t n) {
        const PointTree::Node& node = points_.tree.nodes[n];
        float enter = nearest, leave = hit.distance;
        for (int axis = 0; axis < 3; ++axis) {
            const float a = (node.low[axis] - widest_[n] - from[axis]) * slope[axis];
            const float b = (node.high[axis] + widest_[n] - from[axis]) * slope[axis];
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter <= leave ? enter : std::numeric_limits<float>::infinity();
    };

    struct Step {
        std::uint32_t node;
        float enter;
    };
    // 21 levels of octants and the halving of full cells: seven more entries a level at most.
    std::vector<Step> stack;
    stack.reserve(256);
    stack.push_back({0, entry(0)});
    while (!stack.empty()) {
        const Step step = stack.back();
        stack.pop_back();
        if (!(step.enter <= hit.distance)) continue;
        const PointTree::Node& node = points_.tree.nodes[step.node];
        if (node.children > 0) {
            const std::size_t begin = stack.size();
            for (std::uint32_t c = node.first_child; c < node.first_child + node.children; ++c) {
                const float enter = entry(c);
                if (enter <= hit.distance) stack.push_back({c, enter});
            }
            std::sort(stack.begin() + static_cast<std::ptrdiff_t>(begin), stack.end(),
                      [](const Step& a, const Step& b) {
                          return a.enter != b.enter ? a.enter > b.enter : a.node > b.node;
                      });
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const LocalPlane& plane = planes_[i];
            if (!(plane.area > 0.0f)) continue;
            const float cosine = dot(plane.normal, direction);
            const Vec3f centre = points_.tree.position(i) - from + plane.normal * plane.height;
            const float t = dot(plane.normal, centre) / cosine;
            if (!(t >= nearest && t < hit.distance)) continue;
            const Vec3f off = direction * t - centre;
            const float reach = kOverlap * radius_of(plane);
            if (dot(off, off) <= reach * reach) hit = {i, t};
        }
    }
    return hit;
}

}  // namespace glowworm

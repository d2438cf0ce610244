#pragma once

#include <cstdint>

#include "octree/ray_lanes.h"
#include "octree/ray_tracer.h"

/// How the rays of ray_lanes.h meet the patches of a leaf: the sums of trace.cpp, three axes at
/// once.
namespace glowworm::ray_lanes {

/// x, y, z and something else.
using Axes [[gnu::vector_size(16), gnu::may_alias]] = float;
using AxisBits [[gnu::vector_size(16), gnu::may_alias]] = std::int32_t;

GLOWWORM_INLINE Axes axes(const Vec3f& v, float w = 0.0f) {
    return Axes{v.x, v.y, v.z, w};
}

GLOWWORM_INLINE Axes everywhere(float v) {
    return Axes{v, v, v, v};
}

/// The sums x + y + z of four vectors.
GLOWWORM_INLINE Axes sums(Axes a, Axes b, Axes c, Axes d) {
    const Axes ab_xy = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const Axes cd_xy = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const Axes ab_z = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Axes cd_z = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    const Axes x = __builtin_shufflevector(ab_xy, cd_xy, 0, 1, 4, 5);
    const Axes y = __builtin_shufflevector(ab_xy, cd_xy, 2, 3, 6, 7);
    const Axes z = __builtin_shufflevector(ab_z, cd_z, 0, 1, 4, 5);
    return x + y + z;
}

GLOWWORM_INLINE Axes absolute(Axes v) {
    const AxisBits all_but_sign = AxisBits{} + 0x7fffffff;
    return reinterpret_cast<Axes>(reinterpret_cast<AxisBits>(v) & all_but_sign);
}

GLOWWORM_INLINE bool all_axes(AxisBits v) {
    using Halves [[gnu::vector_size(16)]] = std::int64_t;
    const Halves halves = reinterpret_cast<Halves>(v | AxisBits{0, 0, 0, -1});
    return (halves[0] & halves[1]) == -1;
}

/// The rays in lanes, in metres.
struct RaysInLanes {
    Axes origin[kLanes];     // w: t_max
    Axes direction[kLanes];  // w: t_min
    Axes normal[kLanes];

    GLOWWORM_INLINE void set(int lane, const Ray& ray) {
        origin[lane] = axes(ray.origin, ray.t_max);
        direction[lane] = axes(ray.direction, ray.t_min);
        normal[lane] = axes(ray.normal);
    }
    GLOWWORM_INLINE void move(int from, int to) {
        origin[to] = origin[from];
        direction[to] = direction[from];
        normal[to] = normal[from];
    }
};

/// How a ray meets the plane of a patch.
struct PlaneHit {
    float t, slope;
    float facing;   // cosine times the ndf's length, to the surface that the ray leaves
    float ahead;    // m along the ray, of the patch's middle
    bool on_patch;  // but for what beyond_edge() says
    Axes point;     // m
};

struct LeafSize {
    Axes half, reach;  // m
};

GLOWWORM_INLINE PlaneHit meet(const RayTracer::Patch& patch, const RaysInLanes& rays, int lane,
                              Axes corner, const LeafSize& size) {
    const Axes* rows = reinterpret_cast<const Axes*>(&patch);
    const Axes origin = rays.origin[lane], direction = rays.direction[lane];
    const Axes offset = rows[0] - origin;
    const Axes ndf = rows[1];
    const Axes of =
        sums(ndf * offset, ndf * direction, ndf * rays.normal[lane], offset * direction);
    const float t = of[0] / of[1];
    const Axes point = origin + direction * t;
    const Axes at = point - corner;
    const AxisBits on =
        (at >= rows[2]) & (at <= rows[3]) & (absolute(at - size.half) <= size.reach);
    return {t, of[1], of[2], of[3], all_axes(on), point};
}

/// Whether `point` on the plane of a patch lies beyond the edge that it forms with `other`.
inline bool beyond_edge(const RayTracer::Patch& patch, const RayTracer::Patch& other, Axes point) {
    const Vec3f apart = patch.position - other.position;
    const float side = dot(other.ndf, apart);
    const float other_side = -dot(patch.ndf, apart);
    if (side * other_side <= 0.0f) return false;
    const float at = dot(other.ndf, Vec3f{point[0], point[1], point[2]} - other.position);
    return side < 0.0f ? at > 0.0f : at < 0.0f;
}

/// Calls `visit(patch, hit, met)` for the patches of a leaf, in order, until it returns true;
/// whether it did.
template <typename Visit>
GLOWWORM_INLINE bool visit_leaf(const RayTracer::Patch* patches, std::uint32_t leaf,
                                const RaysInLanes& rays, int lane, Axes corner,
                                const LeafSize& size, const Visit& visit) {
    const RayTracer::Patch& first = patches[leaf];
    const RayTracer::Patch* patch = &first;
    for (std::uint32_t k = 0;;) {
        const PlaneHit hit = meet(*patch, rays, lane, corner, size);
        const auto met = [&]() __attribute__((always_inline)) {
            if (first.wedge == 0 || k > 1) return true;
            return !beyond_edge(*patch, k == 0 ? patches[first.others] : first, hit.point);
        };
        if (visit(*patch, hit, met)) return true;
        if (++k == first.count) return false;
        patch = patches + first.others + (k - 1);
    }
}

}  // namespace glowworm::ray_lanes

#pragma once

#include <cstdint>
#include <span>

#include "octree/ray_leaves.h"
#include "octree/ray_leaves_together.h"
#include "octree/ray_tracer.h"

/// What rays in lanes look for, and when they end.
namespace glowworm::ray_lanes {

// trace.cpp says what these are.
inline constexpr float kLeastBehind = 2.0f;
inline constexpr float kSameSurface = 0.5f;
inline constexpr float kLampHeight = 0.5f;
inline constexpr float kLampCosine = 0.8f;

/// The rule of trace_ray().
struct FirstFront {
    std::span<const Ray> rays;
    std::span<std::uint32_t> lobes;
    std::uint32_t candidate[2][kLanes];

    GLOWWORM_INLINE std::size_t size() const { return rays.size(); }
    GLOWWORM_INLINE const Ray& ray(std::size_t i) const { return rays[i]; }
    GLOWWORM_INLINE void begin(int bundle, int lane) { candidate[bundle][lane] = kNoHit; }
    GLOWWORM_INLINE void move(int bundle, int from, int to) {
        candidate[bundle][to] = candidate[bundle][from];
    }
    GLOWWORM_INLINE void end(int bundle, int lane, std::size_t i) {
        lobes[i] = candidate[bundle][lane];
    }

    /// Whether the ray ends in the leaf.
    GLOWWORM_INLINE bool pass(const RayTracer::Patch* patches, std::uint32_t leaf,
                              const RaysInLanes& in, int bundle, int lane, std::size_t i,
                              Axes corner, const LeafSize& leaf_size) {
        float nearest = in.origin[lane][3];
        std::uint32_t hit = kNoHit;
        bool behind = false;
        std::uint32_t passed = candidate[bundle][lane];
        visit_leaf(
            patches, leaf, in, lane, corner, leaf_size,
            [&](const RayTracer::Patch& patch, const PlaneHit& h, const auto& met)
                __attribute__((always_inline)) {
                    const float t_min = h.facing > kSameSurface ? in.direction[lane][3] : 0.0f;
                    if (bool(int(h.t >= t_min) & int(h.t < nearest) & int(h.on_patch)) && met()) {
                        nearest = h.t;
                        hit = patch.lobe;
                        // a lamp's back is black, not rock
                        behind = h.slope > 0.0f && patch.light == 0;
                    } else {
                        const bool front =
                            int(h.slope < 0.0f) & int(passed == kNoHit) & int(h.ahead > t_min);
                        passed = front ? patch.lobe : passed;
                    }
                    return false;
                });
        candidate[bundle][lane] = passed;
        if (hit == kNoHit) return false;
        lobes[i] = !behind ? hit : passed != kNoHit ? passed : kBuried;
        return true;
    }

    /// Which of the leaves with one patch end their rays, a bit each.
    GLOWWORM_INLINE std::uint32_t pass(const LeavesTogether& leaves, const PlaneHits& h,
                                       const RaysInLanes&, int bundle, const std::size_t* ray_of) {
        const Floats t_min = h.facing > kSameSurface ? h.t_min : Floats{};
        const Ints hit = (h.t >= t_min) & (h.t < h.t_max) & h.on_patch;
        const Ints front = ~hit & (h.slope < 0.0f) & (h.ahead > t_min);
        const std::uint32_t hits = signs(hit) & h.single;
        const std::uint32_t behind = signs((h.slope > 0.0f) & (h.light == 0));
        for_each_bit(
            signs(front) & h.single, [&](int k) __attribute__((always_inline)) {
                std::uint32_t& passed = candidate[bundle][leaves.lane[k]];
                passed = passed == kNoHit ? leaves.patch[k]->lobe : passed;
            });
        for_each_bit(
            hits, [&](int k) __attribute__((always_inline)) {
                const std::uint32_t passed = candidate[bundle][leaves.lane[k]];
                lobes[ray_of[leaves.lane[k]]] = (behind >> k & 1u) == 0 ? leaves.patch[k]->lobe
                                                : passed != kNoHit      ? passed
                                                                        : kBuried;
            });
        return hits;
    }
};

/// The rule of is_unoccluded().
struct AnythingBetween {
    std::span<const ShadowRay> rays;
    std::span<std::uint8_t> seen;
    float edge;  // m

    GLOWWORM_INLINE std::size_t size() const { return rays.size(); }
    GLOWWORM_INLINE const Ray& ray(std::size_t i) const { return rays[i].ray; }
    GLOWWORM_INLINE void begin(int, int) {}
    GLOWWORM_INLINE void move(int, int, int) {}
    GLOWWORM_INLINE void end(int, int, std::size_t i) { seen[i] = 1; }

    GLOWWORM_INLINE bool pass(const RayTracer::Patch* patches, std::uint32_t leaf,
                              const RaysInLanes& in, int, int lane, std::size_t i, Axes corner,
                              const LeafSize& leaf_size) {
        const ShadowTarget& target = rays[i].target;
        const bool blocked = visit_leaf(
            patches, leaf, in, lane, corner, leaf_size,
            [&](const RayTracer::Patch& patch, const PlaneHit& h, const auto& met)
                __attribute__((always_inline)) {
                    if (patch.light != 0 && patch.light == target.light) return false;
                    const bool same = h.facing > kSameSurface;
                    float least = same ? in.direction[lane][3] : 0.0f;
                    if (same && h.slope > 0.0f) least = std::max(least, kLeastBehind * edge);
                    if (!bool(int(h.t >= least) & int(h.t <= in.origin[lane][3]) & int(h.on_patch)))
                        return false;
                    return met() && !is_lamps_wall(patch, h.point, i);
                });
        if (blocked) seen[i] = 0;
        return blocked;
    }

    GLOWWORM_INLINE std::uint32_t pass(const LeavesTogether& leaves, const PlaneHits& h,
                                       const RaysInLanes& in, int, const std::size_t* ray_of) {
        const Ints same = h.facing > kSameSurface;
        const Floats t_min = same ? h.t_min : Floats{};
        const Floats behind = Floats{} + kLeastBehind * edge;
        const Floats least = (same & (h.slope > 0.0f) & (t_min < behind)) ? behind : t_min;
        std::uint32_t blocked = 0;
        const Ints hit = (h.t >= least) & (h.t <= h.t_max) & h.on_patch;
        for_each_bit(
            signs(hit) & h.single, [&](int k) __attribute__((always_inline)) {
                const RayTracer::Patch& patch = *leaves.patch[k];
                const int lane = leaves.lane[k];
                const std::size_t i = ray_of[lane];
                if (patch.light != 0 && patch.light == rays[i].target.light) return;
                const Axes point = in.origin[lane] + in.direction[lane] * everywhere(h.t[k]);
                if (is_lamps_wall(patch, point, i)) return;
                seen[i] = 0;
                blocked |= 1u << k;
            });
        return blocked;
    }

  private:
    /// Whether what ray `i` meets at `point` is flush with the lamp that it ends on.
    GLOWWORM_INLINE bool is_lamps_wall(const RayTracer::Patch& patch, Axes point,
                                       std::size_t i) const {
        const Ray& r = rays[i].ray;
        const ShadowTarget& target = rays[i].target;
        const Vec3f end = r.origin + r.direction * r.t_max;
        const Vec3f at{point[0], point[1], point[2]};
        return !(std::abs(dot(target.normal, at - end)) >= kLampHeight * edge ||
                 std::abs(dot(target.normal, patch.ndf)) <= kLampCosine);
    }
};

}  // namespace glowworm::ray_lanes

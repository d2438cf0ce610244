#include "octree/ray_tracer.h"

#include "octree/ray_lanes.h"
#include "octree/ray_leaves.h"
#include "octree/wide.h"

namespace glowworm {

namespace {

using namespace ray_lanes;

constexpr float kLeastBehind = 2.0f;  // trace.cpp says what these are
constexpr float kSameSurface = 0.5f;
constexpr float kLampHeight = 0.5f;
constexpr float kLampCosine = 0.8f;

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
                    if (!met()) return false;
                    const Ray& r = rays[i].ray;
                    const Vec3f end = r.origin + r.direction * r.t_max;
                    const Vec3f point{h.point[0], h.point[1], h.point[2]};
                    return std::abs(dot(target.normal, point - end)) >= kLampHeight * edge ||
                           std::abs(dot(target.normal, patch.ndf)) <= kLampCosine;
                });
        if (blocked) seen[i] = 0;
        return blocked;
    }
};

/// Lanes that are looked up together and advance together.
struct Bundle {
    Walks walks;
    RaysInLanes rays;
    std::size_t ray_of[kLanes];
    std::uint32_t leaf[kLanes];
    int at_leaf[kLanes];  // lanes
    int leaves = 0, busy = 0;
};

}  // namespace

template <typename Rule>
GLOWWORM_INLINE void RayTracer::walk(Rule& rule) const {
    const auto cells = static_cast<std::int32_t>(1u << grid_.depth);
    const float edge = grid_.voxel_size();
    const Axes cube_min = axes(grid_.cube_min);
    const LeafSize leaf_size{everywhere(0.5f * edge), everywhere(settings_.reach * edge)};
    Bundle bundles[2] = {};
    std::size_t next = 0;

    // Gives a lane to the next ray that enters the cube; false where none is left.
    const auto refill = [&](int b, int lane) __attribute__((always_inline)) {
        while (next < rule.size()) {
            const std::size_t i = next++;
            rule.begin(b, lane);
            bundles[b].ray_of[lane] = i;
            bundles[b].rays.set(lane, rule.ray(i));
            if (begin(grid_, rule.ray(i), lane, bundles[b].walks)) return true;
            rule.end(b, lane, i);
        }
        return false;
    };
    for (int b = 0; b < 2; ++b) {
        while (bundles[b].busy < kLanes && refill(b, bundles[b].busy))
            ++bundles[b].busy;
    }

    // While one bundle advances, what the other is about to read comes from memory.
    const auto find_leaves = [&](Bundle & in) __attribute__((always_inline)) {
        for (int group = 0; group < kGroups; ++group)
            look_up(occupancy_, group, in.walks);
        in.leaves = 0;
        for (int lane = 0; lane < in.busy; ++lane) {
            in.at_leaf[in.leaves] = lane;
            in.leaves += in.walks.is_leaf.lane[lane];
        }
        for (int i = 0; i < in.leaves; ++i) {
            const int lane = in.at_leaf[i];
            const Occupancy::Brick& brick = occupancy_.bricks[in.walks.brick.lane[lane]];
            in.leaf[lane] = brick.first + Occupancy::before(brick, in.walks.bit.lane[lane]);
            __builtin_prefetch(&patches_[in.leaf[lane]]);
        }
    };
    const auto advance = [&](int b) __attribute__((always_inline)) {
        Bundle& in = bundles[b];
        Row<std::int32_t> met;
        for (int group = 0; group < kGroups; ++group)
            met.group<Ints>(group) = Ints{};
        for (int i = 0; i < in.leaves; ++i) {
            const int lane = in.at_leaf[i];
            const AxisBits cell = {in.walks.cell[0].lane[lane], in.walks.cell[1].lane[lane],
                                   in.walks.cell[2].lane[lane], 0};
            const Axes corner = cube_min + __builtin_convertvector(cell, Axes) * edge;
            met.lane[lane] = rule.pass(patches_.data(), in.leaf[lane], in.rays, b, lane,
                                       in.ray_of[lane], corner, leaf_size)
                                 ? 1
                                 : 0;
        }
        for (int group = 0; group < kGroups; ++group)
            step(cells, group, in.walks);
        int ended[kLanes];
        int ends = 0;
        for (int lane = in.busy - 1; lane >= 0; --lane) {
            ended[ends] = lane;
            ends += (met.lane[lane] | in.walks.ended.lane[lane]) != 0 ? 1 : 0;
        }
        for (int i = 0; i < ends; ++i) {
            const int lane = ended[i];
            if (met.lane[lane] == 0) rule.end(b, lane, in.ray_of[lane]);
            if (refill(b, lane)) continue;
            // Busy lanes stay the first ones.
            const int last = --in.busy;
            in.ray_of[lane] = in.ray_of[last];
            in.rays.move(last, lane);
            move(last, lane, in.walks);
            rule.move(b, last, lane);
        }
    };
    find_leaves(bundles[0]);
    for (int b = 0; bundles[0].busy + bundles[1].busy > 0; b ^= 1) {
        find_leaves(bundles[b ^ 1]);
        advance(b);
    }
}

RayTracer::RayTracer(const OctreeView& octree, const TraceSettings& settings)
    : grid_(octree.grid), settings_(settings) {
    if (octree.nodes.empty()) return;
    occupancy_ = make_occupancy(octree);
    const float edge = grid_.voxel_size();
    const auto corner = [&](std::uint32_t packed) {
        const float scale = edge / 255.0f;
        return Vec3f{static_cast<float>(packed & 255u) * scale,
                     static_cast<float>((packed >> 8) & 255u) * scale,
                     static_cast<float>((packed >> 16) & 255u) * scale};
    };
    const auto patch_of = [&](std::uint32_t i) {
        const Lobe& lobe = octree.lobes[i];
        const float margin = settings.patch_margin * lobe.spacing;
        Patch patch;
        patch.position = to_vec3(lobe.position);
        patch.lobe = i;
        patch.ndf = to_vec3(lobe.ndf);
        patch.light = lobe.light;
        patch.low = corner(lobe.patch_min) - Vec3f{margin, margin, margin};
        patch.high = corner(lobe.patch_max) + Vec3f{margin, margin, margin};
        return patch;
    };
    const Level leaves = octree.levels[octree.grid.depth];
    patches_.reserve(octree.lobes.size());
    patches_.resize(leaves.node_count);
    for (std::uint32_t i = 0; i < leaves.node_count; ++i) {
        const Node& leaf = octree.nodes[leaves.first_node + i];
        Patch first = patch_of(leaf.first);
        first.count = static_cast<std::uint16_t>((leaf.mask >> 8) & 3u);
        first.others = static_cast<std::uint32_t>(patches_.size());
        const Lobe& last = octree.lobes[leaf.first + first.count - 1u];
        const bool last_emits = last.light != 0 || last.emission != 0;
        first.wedge = first.count == (last_emits ? 3 : 2) ? 1 : 0;
        for (std::uint32_t k = 1; k < first.count; ++k)
            patches_.push_back(patch_of(leaf.first + k));
        patches_[i] = first;
    }
}

GLOWWORM_WIDE void RayTracer::trace(std::span<const Ray> rays,
                                    std::span<std::uint32_t> lobes) const {
    FirstFront rule{rays, lobes, {}};
    if (!patches_.empty()) return walk(rule);
    std::fill(lobes.begin(), lobes.end(), kNoHit);
}

GLOWWORM_WIDE void RayTracer::look(std::span<const ShadowRay> rays,
                                   std::span<std::uint8_t> seen) const {
    AnythingBetween rule{rays, seen, grid_.voxel_size()};
    if (!patches_.empty()) return walk(rule);
    std::fill(seen.begin(), seen.end(), std::uint8_t{1});
}

}  // namespace glowworm

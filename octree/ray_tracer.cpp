#include "octree/ray_tracer.h"

#include "octree/close_patches.h"
#include "octree/ray_lanes.h"
#include "octree/ray_leaves.h"
#include "octree/ray_leaves_together.h"
#include "octree/ray_rules.h"
#include "octree/wide.h"

namespace glowworm {

namespace {

using namespace ray_lanes;

/// Lanes that are looked up together and advance together.
struct Bundle {
    Walks walks;
    RaysInLanes rays;
    std::size_t ray_of[kLanes];
    std::uint32_t leaf[kLanes];   // by lane
    int at_leaf[kLanes];          // lanes
    Row<std::int32_t> corner[3];  // cells of those leaves
    int leaves = 0, busy = 0;

    GLOWWORM_INLINE std::uint32_t busy_lanes() const {
        return static_cast<std::uint32_t>((std::uint64_t{1} << busy) - 1u);
    }
};

}  // namespace

template <typename Rule>
GLOWWORM_INLINE void RayTracer::walk(Rule& rule) const {
    const auto cells = static_cast<std::int32_t>(1u << grid_.depth);
    const float edge = grid_.voxel_size();
    const float cube_min[3] = {grid_.cube_min.x, grid_.cube_min.y, grid_.cube_min.z};
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
        const std::uint32_t leaves = signs(in.walks.is_leaf.lane, kLanes) & in.busy_lanes();
        for_each_bit(
            leaves, [&](int lane) __attribute__((always_inline)) {
                const Occupancy::Brick& brick = occupancy_.bricks[in.walks.brick.lane[lane]];
                in.leaf[lane] = brick.first + Occupancy::before(brick, in.walks.bit.lane[lane]);
                __builtin_prefetch(&patches_[in.leaf[lane]]);
                for (int a = 0; a < 3; ++a)
                    in.corner[a].lane[in.leaves] = in.walks.cell[a].lane[lane];
                in.at_leaf[in.leaves++] = lane;
            });
    };
    const auto meet_leaves = [&](int b) __attribute__((always_inline)) {
        Bundle& in = bundles[b];
        std::uint32_t met = 0;
        for (int first = 0; first < in.leaves; first += kWidth) {
            LeavesTogether leaves;
            const int count = std::min(in.leaves - first, kWidth);
            leaves.all = (1u << count) - 1u;
            for (int k = 0; k < kWidth; ++k) {
                leaves.lane[k] = in.at_leaf[first + (k < count ? k : 0)];
                leaves.patch[k] = &patches_[in.leaf[leaves.lane[k]]];
            }
            Floats corner[3];
            for (int a = 0; a < 3; ++a) {
                const Ints cell = in.corner[a].group<Ints>(first / kWidth);
                corner[a] = cube_min[a] + __builtin_convertvector(cell, Floats) * edge;
            }
            PlaneHits hits;
            meet_together(leaves, in.rays, corner, leaf_size.half[0], leaf_size.reach[0], hits);
            std::uint32_t ended = rule.pass(leaves, hits, in.rays, b, in.ray_of);
            for_each_bit(
                leaves.all & ~hits.single, [&](int k) __attribute__((always_inline)) {
                    const int lane = leaves.lane[k];
                    const Axes at{corner[0][k], corner[1][k], corner[2][k], 0.0f};
                    if (rule.pass(patches_.data(), in.leaf[lane], in.rays, b, lane, in.ray_of[lane],
                                  at, leaf_size))
                        ended |= 1u << k;
                });
            for_each_bit(
                ended, [&](int k) __attribute__((always_inline)) { met |= 1u << leaves.lane[k]; });
        }
        return met;
    };
    const auto advance = [&](int b) __attribute__((always_inline)) {
        Bundle& in = bundles[b];
        const std::uint32_t met = meet_leaves(b);
        for (int group = 0; group < kGroups; ++group)
            step(cells, group, in.walks);
        std::uint32_t ended = (met | signs(in.walks.ended.lane, kLanes)) & in.busy_lanes();
        while (ended != 0) {  // the last lane first
            const int lane = static_cast<int>(std::bit_width(ended)) - 1;
            ended ^= 1u << lane;
            if ((met >> lane & 1u) == 0) rule.end(b, lane, in.ray_of[lane]);
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

std::shared_ptr<const RayTracer> make_ray_tracer(const OctreeView& octree,
                                                 const TraceSettings& settings) {
    const std::vector<Lobe> lobes = close_patches(octree);
    OctreeView closed = octree;
    closed.lobes = lobes;
    return std::make_shared<RayTracer>(closed, settings);
}

}  // namespace glowworm

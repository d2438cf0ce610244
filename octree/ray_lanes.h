#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "octree/grid.h"
#include "octree/occupancy.h"
#include "octree/trace.h"

/// The walks of trace.cpp side by side, in lanes of vector registers. The same steps by the same
/// sums in the same order, so that they pass the same leaves at the same distances. Everything here
/// is inlined into what ray_tracer.cpp compiles for more than one kind of processor.
namespace glowworm::ray_lanes {

#define GLOWWORM_INLINE inline __attribute__((always_inline))

constexpr int kWidth = 8;   // numbers in a register
constexpr int kGroups = 4;  // registers that walk together: one waits while another reckons
constexpr int kLanes = kWidth * kGroups;  // up to 32: a bit each

using Floats [[gnu::vector_size(4 * kWidth), gnu::may_alias]] = float;
using Ints [[gnu::vector_size(4 * kWidth), gnu::may_alias]] = std::int32_t;
using Words [[gnu::vector_size(4 * kWidth), gnu::may_alias]] = std::uint32_t;

template <typename Element>
struct alignas(4 * kWidth) Row {
    Element lane[kLanes];

    template <typename Register>
    GLOWWORM_INLINE Register& group(int g) {
        return reinterpret_cast<Register&>(lane[g * kWidth]);
    }
    GLOWWORM_INLINE void move(int from, int to) { lane[to] = lane[from]; }
};

/// In leaf edges from the cube's lower corner. Whatever a lane holds that is not in use, its cell
/// lies in the cube.
struct Walks {
    Row<float> origin[3], direction[3], inverse[3];
    Row<float> t, t_end;
    Row<std::int32_t> ahead[3];  // all bits where the walk goes up the axis
    Row<std::int32_t> cell[3];
    Row<std::int32_t> size;         // of the cell that the next step leaves
    Row<std::int32_t> ended;        // all bits where the last step left the cube or the ray
    Row<std::uint32_t> brick, bit;  // where Occupancy knows of the cell
    Row<std::int32_t> is_leaf;      // all bits where it holds a leaf
};

/// Puts a ray into a lane. False where it misses the cube.
GLOWWORM_INLINE bool begin(const Grid& grid, const Ray& ray, int lane, Walks& w) {
    const float per_edge = 1.0f / grid.voxel_size();
    const auto cells = static_cast<float>(1u << grid.depth);
    float enter = 0.0f;
    float leave = ray.t_max * per_edge;
    for (int a = 0; a < 3; ++a) {
        const float origin = (ray.origin[a] - grid.cube_min[a]) * per_edge;
        const float d = ray.direction[a];
        const float direction = std::abs(d) < 1e-9f ? std::copysign(1e-9f, d) : d;
        const float inverse = 1.0f / direction;
        const float t0 = (0.0f - origin) * inverse;
        const float t1 = (cells - origin) * inverse;
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
        w.origin[a].lane[lane] = origin;
        w.direction[a].lane[lane] = direction;
        w.inverse[a].lane[lane] = inverse;
        w.ahead[a].lane[lane] = direction > 0.0f ? -1 : 0;
    }
    w.t.lane[lane] = enter;
    w.t_end.lane[lane] = leave;
    for (int a = 0; a < 3; ++a) {
        const float at = w.origin[a].lane[lane] + w.direction[a].lane[lane] * enter;
        w.cell[a].lane[lane] = static_cast<std::int32_t>(std::clamp(at, 0.0f, cells - 1.0f));
    }
    return enter <= leave;
}

GLOWWORM_INLINE void move(int from, int to, Walks& w) {
    for (int a = 0; a < 3; ++a) {
        w.origin[a].move(from, to);
        w.direction[a].move(from, to);
        w.inverse[a].move(from, to);
        w.ahead[a].move(from, to);
        w.cell[a].move(from, to);
    }
    w.t.move(from, to);
    w.t_end.move(from, to);
}

/// Reads a word for each lane.
template <typename Read>
GLOWWORM_INLINE void gather(const Read& read, Words& words) {
    static_assert(kWidth == 8);
    words = Words{read(0), read(1), read(2), read(3), read(4), read(5), read(6), read(7)};
}

/// Of three coordinates, the bits at `shift`: an octant.
GLOWWORM_INLINE void octant_at(const Words& x, const Words& y, const Words& z, std::int32_t shift,
                               Words& octant) {
    octant = (x >> shift & 1u) | (y >> shift & 1u) << 1 | (z >> shift & 1u) << 2;
}

/// Looks up the cells that a group is in, without branches: what a walk comes to is not foreseen.
GLOWWORM_INLINE void look_up(const Occupancy& occupancy, int group, Walks& w) {
    const Words x = w.cell[0].group<Words>(group), y = w.cell[1].group<Words>(group),
                z = w.cell[2].group<Words>(group);
    const std::int32_t level = occupancy.table_level;
    std::int32_t shift = occupancy.table_shift;
    const Words entry = ((z >> shift << level | y >> shift) << level) | x >> shift;
    Words brick, octant, coarse, cells, size, bit{};
    gather([&](int i) { return occupancy.table[entry[i]]; }, brick);
    octant_at(x, y, z, shift - 1, octant);
    brick += octant;
    Words deeper = ~Words{};  // whose bricks are of the level reached
    for (;;) {
        shift -= 3;
        octant_at(x, y, z, shift + 1, coarse);
        octant_at(x, y, z, shift, octant);
        bit = deeper ? coarse << 3 | octant : bit;
        const Words half = bit >> 5;
        gather([&](int i) { return occupancy.bricks[brick[i]].cells[half[i]]; }, cells);
        gather([&](int i) { return static_cast<std::uint32_t>(occupancy.bricks[brick[i]].size); },
               size);
        if (shift == 0) break;
        deeper = deeper & -(cells >> (bit & 31u) & 1u);
        for (int i = 0; i < kWidth; ++i) {
            if (deeper[i] == 0) continue;
            const Occupancy::Brick& here = occupancy.bricks[brick[i]];
            const auto side = [&](const Words& v) { return v[i] >> (shift - 1) & 1u; };
            brick[i] = here.first + 8 * Occupancy::before(here, bit[i]) +
                       (side(x) | side(y) << 1 | side(z) << 2);
        }
    }
    const Words alone = reinterpret_cast<Words>((cells >> (bit & 24u) & 255u) == 0u);
    w.size.group<Words>(group) = size + (size & alone);
    w.is_leaf.group<Words>(group) = -(cells >> (bit & 31u) & 1u);
    w.brick.group<Words>(group) = brick;
    w.bit.group<Words>(group) = bit;
}

/// Steps every walk of a group over the cell that was looked up, of an octree of `cells` leaf
/// edges.
GLOWWORM_INLINE void step(std::int32_t cells, int group, Walks& w) {
    const Ints size = w.size.group<Ints>(group);
    Ints low[3];
    Floats exit[3];
    for (int a = 0; a < 3; ++a) {
        low[a] = w.cell[a].group<Ints>(group) & -size;
        const Ints face = low[a] + (size & w.ahead[a].group<Ints>(group));
        exit[a] = (__builtin_convertvector(face, Floats) - w.origin[a].group<Floats>(group)) *
                  w.inverse[a].group<Floats>(group);
    }
    const Ints is_y = exit[1] < exit[0];
    const Floats first = is_y ? exit[1] : exit[0];
    const Ints is_z = exit[2] < first;
    const Floats least = is_z ? exit[2] : first;
    const Ints along[3] = {~(is_y | is_z), is_y & ~is_z, is_z};

    Floats& t = w.t.group<Floats>(group);
    t = t < least ? least : t;
    Ints outside = {};
    for (int a = 0; a < 3; ++a) {
        const Ints high = low[a] + size;
        const Floats lowest = __builtin_convertvector(low[a], Floats);
        const Floats highest = __builtin_convertvector(high - 1, Floats);
        Floats at = w.origin[a].group<Floats>(group) + w.direction[a].group<Floats>(group) * t;
        at = at < lowest ? lowest : at;
        at = highest < at ? highest : at;
        const Ints next = w.ahead[a].group<Ints>(group) ? high : low[a] - 1;
        const Ints cell = along[a] ? next : __builtin_convertvector(at, Ints);
        outside |= cell;
        w.cell[a].group<Ints>(group) = cell & (cells - 1);
    }
    const Ints over = t > w.t_end.group<Floats>(group);
    w.ended.group<Ints>(group) = over | ((outside & ~(cells - 1)) != 0);
}

}  // namespace glowworm::ray_lanes

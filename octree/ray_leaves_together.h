#pragma once

#include <bit>
#include <cstdint>

#include "octree/ray_leaves.h"

/// Leaves with a single patch, as most are, side by side: the sums of meet(), in the same order, of
/// kWidth rays at once.
namespace glowworm::ray_lanes {

/// Of a row's lanes a bit each: whether its highest bit is set.
GLOWWORM_INLINE std::uint32_t signs(const std::int32_t* lanes, int count) {
    std::uint32_t bits = 0;
#if defined(__SSE2__)
    using Four [[gnu::vector_size(16), gnu::may_alias]] = float;
    for (int i = 0; i < count; i += 4) {
        const auto four = __builtin_ia32_movmskps(*reinterpret_cast<const Four*>(lanes + i));
        bits |= static_cast<std::uint32_t>(four) << i;
    }
#else
    for (int i = 0; i < count; ++i)
        bits |= static_cast<std::uint32_t>(lanes[i] < 0) << i;
#endif
    return bits;
}

GLOWWORM_INLINE std::uint32_t signs(const Ints& v) {
    alignas(4 * kWidth) std::int32_t lanes[kWidth];
    reinterpret_cast<Ints&>(lanes) = v;
    return signs(lanes, kWidth);
}

/// Calls `visit(i)` for every bit that is set, the lowest first.
template <typename Visit>
GLOWWORM_INLINE void for_each_bit(std::uint32_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1)
        visit(std::countr_zero(bits));
}

/// Rows of four numbers, one of each of kWidth records, as four registers.
GLOWWORM_INLINE void turn_over(const Axes* const (&rows)[kWidth], Floats (&out)[4]) {
    static_assert(kWidth == 8);
    Floats both[4];
    for (int k = 0; k < 4; ++k)
        both[k] = __builtin_shufflevector(*rows[k], *rows[k + 4], 0, 1, 2, 3, 4, 5, 6, 7);
    const Floats xy = __builtin_shufflevector(both[0], both[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const Floats zw = __builtin_shufflevector(both[0], both[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const Floats xy_2 = __builtin_shufflevector(both[2], both[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const Floats zw_2 = __builtin_shufflevector(both[2], both[3], 2, 10, 3, 11, 6, 14, 7, 15);
    out[0] = __builtin_shufflevector(xy, xy_2, 0, 1, 8, 9, 4, 5, 12, 13);
    out[1] = __builtin_shufflevector(xy, xy_2, 2, 3, 10, 11, 6, 7, 14, 15);
    out[2] = __builtin_shufflevector(zw, zw_2, 0, 1, 8, 9, 4, 5, 12, 13);
    out[3] = __builtin_shufflevector(zw, zw_2, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// Leaves that rays of a bundle are in, kWidth or fewer; the others repeat the first.
struct LeavesTogether {
    const RayTracer::Patch* patch[kWidth];  ///< each leaf's first
    int lane[kWidth];
    std::uint32_t all = 0;  ///< a bit for each that is none of the others
};

/// PlaneHit of each of them.
struct PlaneHits {
    Floats t, slope, facing, ahead;
    Floats t_min, t_max;  // the rays'
    Ints on_patch;
    Ints light;            // Patch::light
    std::uint32_t single;  // a bit for each leaf with one patch: of others the rest means nothing
};

GLOWWORM_INLINE void meet_together(const LeavesTogether& leaves, const RaysInLanes& rays,
                                   const Floats (&corner)[3], float half, float reach,
                                   PlaneHits& hits) {
    const Axes* rows[kWidth];
    const auto row_of_patch = [&](int row, Floats(&out)[4]) __attribute__((always_inline)) {
        for (int k = 0; k < kWidth; ++k)
            rows[k] = reinterpret_cast<const Axes*>(leaves.patch[k]) + row;
        turn_over(rows, out);
    };
    const auto row_of_ray = [&](const Axes* lanes, Floats(&out)[4]) __attribute__((always_inline)) {
        for (int k = 0; k < kWidth; ++k)
            rows[k] = lanes + leaves.lane[k];
        turn_over(rows, out);
    };
    Floats origin[4], direction[4], normal[4], position[4], ndf[4], low[4], high[4];
    row_of_ray(rays.origin, origin);
    row_of_ray(rays.direction, direction);
    row_of_ray(rays.normal, normal);
    row_of_patch(0, position);
    row_of_patch(1, ndf);
    row_of_patch(2, low);
    row_of_patch(3, high);
    const auto dot =
        [](const Floats* a, const Floats* b, Floats& sum) __attribute__((always_inline)) {
        sum = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    Floats offset[3];
    for (int a = 0; a < 3; ++a)
        offset[a] = position[a] - origin[a];
    Floats height;
    dot(ndf, offset, height);
    dot(ndf, direction, hits.slope);
    dot(ndf, normal, hits.facing);
    dot(offset, direction, hits.ahead);
    hits.t = height / hits.slope;
    hits.t_min = direction[3];
    hits.t_max = origin[3];
    hits.on_patch = ~Ints{};
    for (int a = 0; a < 3; ++a) {
        const Floats at = origin[a] + direction[a] * hits.t - corner[a];
        const Floats apart = at - half;
        const Floats off =
            reinterpret_cast<Floats>(reinterpret_cast<const Ints&>(apart) & (Ints{} + 0x7fffffff));
        hits.on_patch &= (at >= low[a]) & (at <= high[a]) & (off <= reach);
    }
    hits.light = reinterpret_cast<const Ints&>(ndf[3]);
    const Ints counts = reinterpret_cast<const Ints&>(high[3]) & 0xffff;
    hits.single = signs(counts == 1) & leaves.all;
}

}  // namespace glowworm::ray_lanes

#include "preprocess/surface/distances.h"

#include <algorithm>
#include <bit>
#include <cmath>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

// Eight distances at a time where the processor can. No fused operations (-ffp-contract=off), so
// every clone gives the same bits. The sanitizers start too late for the choice at load time.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__)
#define GLOWWORM_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define GLOWWORM_WIDE
#endif

namespace glowworm {
namespace {

/// Steps after which a bound that still has too many points within it is good enough: the nearest
/// of them are then picked one by one.
constexpr int kSteps = 10;

GLOWWORM_WIDE
std::size_t count_within(const float* distance2, std::size_t size, float bound) {
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < size; ++i)
        count += distance2[i] <= bound ? 1 : 0;
    return count;
}

GLOWWORM_WIDE
float largest_within(const float* distance2, std::size_t size, float bound) {
    float largest = 0.0f;
    for (std::size_t i = 0; i < size; ++i) {
        const float d = distance2[i] <= bound ? distance2[i] : 0.0f;
        largest = d > largest ? d : largest;
    }
    return largest;
}

}  // namespace

GLOWWORM_WIDE
void measure_distances(const float* __restrict x, const float* __restrict y,
                       const float* __restrict z, std::size_t size, Vec3f from,
                       float* __restrict distance2) {
    for (std::size_t i = 0; i < size; ++i) {
        const float dx = x[i] - from.x, dy = y[i] - from.y, dz = z[i] - from.z;
        distance2[i] = dx * dx + dy * dy + dz * dz;
    }
}

std::size_t places_within(const float* distance2, std::size_t size, float bound,
                          std::uint32_t* places) {
    std::size_t count = 0;
#ifdef __SSE2__
    const __m128 limit = _mm_set1_ps(bound);
    const auto lanes = [&](std::size_t i) {
        const __m128 within = _mm_cmple_ps(_mm_loadu_ps(distance2 + i), limit);
        return static_cast<std::uint32_t>(_mm_movemask_ps(within));
    };
    for (std::size_t i = 0; i < size; i += kLanes) {
        std::uint32_t mask = lanes(i) | lanes(i + 4) << 4 | lanes(i + 8) << 8 | lanes(i + 12) << 12;
        for (; mask != 0; mask &= mask - 1) {
            places[count++] =
                static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(std::countr_zero(mask));
        }
    }
#else
    for (std::size_t i = 0; i < size; ++i) {
        if (distance2[i] <= bound) places[count++] = static_cast<std::uint32_t>(i);
    }
#endif
    return count;
}

float bound_of(const float* distance2, std::size_t size, std::size_t wanted, float enough,
               float guess) {
    float low = 0.0f, high = enough;
    std::size_t below = 0, above = 0;  // above: unknown until a bound had too many
    float bound = guess;
    if (!(bound > 0.0f && bound < enough)) {
        bound = largest_within(distance2, size, enough);
    }
    for (int step = 0; step < kSteps; ++step) {
        const std::size_t within = count_within(distance2, size, bound);
        if (within == wanted || (within < wanted && bound >= enough)) return bound;
        if (within < wanted) {
            low = bound;
            below = within;
        } else {
            high = bound;
            above = within;
        }
        // On a surface the points within a distance are as many as its square.
        const auto count = static_cast<float>(wanted);
        if (above == 0) {
            bound =
                std::min(low * std::min(1.1f * count / static_cast<float>(within), 4.0f), enough);
        } else if (step % 4 < 3) {
            bound = low + (high - low) * (count - static_cast<float>(below)) /
                              static_cast<float>(above - below);
        } else {
            bound = std::sqrt(std::max(low, 1e-6f * high) * high);
        }
        if (!(bound > low && bound < high) && bound != enough) break;
    }
    return high;
}

}  // namespace glowworm

#include "preprocess/surface/distances.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

// Eight distances at a time where the processor can. No fused operations (-ffp-contract=off), so
// that every processor gives the same bits.
#if defined(__x86_64__) && defined(__GNUC__)
#define GLOWWORM_AVX2 __attribute__((target("avx2")))
#include <immintrin.h>
#endif

namespace glowworm {
namespace {

std::size_t find_within_plain(const float* x, const float* y, const float* z, std::size_t size,
                              Vec3f from, float bound2, std::uint32_t* places, float* distance2) {
    std::size_t found = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const float dx = x[i] - from.x, dy = y[i] - from.y, dz = z[i] - from.z;
        const float d2 = dx * dx + dy * dy + dz * dz;
        places[found] = static_cast<std::uint32_t>(i);
        distance2[found] = d2;
        found += d2 <= bound2 ? 1 : 0;
    }
    return found;
}

void rank_plain(const float* distance2, std::size_t size, std::uint32_t* ranks) {
    const std::size_t padded = pad(size);
    std::fill_n(ranks, padded, 0u);
    for (std::size_t j = 0; j < size; ++j) {
        const float d2 = distance2[j];
        for (std::size_t i = 0; i < padded; ++i)
            ranks[i] += d2 < distance2[i] ? 1u : 0u;
    }
}

#ifdef GLOWWORM_AVX2
const bool kHasAvx2 = __builtin_cpu_supports("avx2");

/// For every mask of eight lanes which of them are set, ascending, a byte each.
constexpr std::array<std::uint64_t, 256> kSetLanes = [] {
    std::array<std::uint64_t, 256> lanes{};
    for (std::size_t mask = 0; mask < 256; ++mask) {
        int shift = 0;
        for (std::uint64_t lane = 0; lane < 8; ++lane) {
            if (!(mask >> lane & 1)) continue;
            lanes[mask] |= lane << shift;
            shift += 8;
        }
    }
    return lanes;
}();

GLOWWORM_AVX2
std::size_t find_within_avx2(const float* x, const float* y, const float* z, std::size_t size,
                             Vec3f from, float bound2, std::uint32_t* places, float* distance2) {
    const __m256 fx = _mm256_set1_ps(from.x), fy = _mm256_set1_ps(from.y),
                 fz = _mm256_set1_ps(from.z), limit = _mm256_set1_ps(bound2);
    std::size_t found = 0;
    for (std::size_t i = 0; i < size; i += kLanes) {
        const __m256 dx = _mm256_sub_ps(_mm256_loadu_ps(x + i), fx);
        const __m256 dy = _mm256_sub_ps(_mm256_loadu_ps(y + i), fy);
        const __m256 dz = _mm256_sub_ps(_mm256_loadu_ps(z + i), fz);
        const __m256 d2 = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)),
                                        _mm256_mul_ps(dz, dz));
        const auto mask =
            static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(d2, limit, _CMP_LE_OQ)));
        if (mask == 0) continue;
        const __m256i lanes =
            _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<std::int64_t>(kSetLanes[mask])));
        const __m256i first = _mm256_set1_epi32(static_cast<int>(i));
        _mm256_storeu_ps(distance2 + found, _mm256_permutevar8x32_ps(d2, lanes));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(places + found),
                            _mm256_add_epi32(first, lanes));
        found += static_cast<std::size_t>(__builtin_popcount(mask));
    }
    return found;
}

GLOWWORM_AVX2
void rank_avx2(const float* distance2, std::size_t size, std::uint32_t* ranks) {
    for (std::size_t i = 0; i < size; i += kLanes) {
        const __m256 own = _mm256_loadu_ps(distance2 + i);
        __m256i rank = _mm256_setzero_si256();
        for (std::size_t j = 0; j < size; ++j) {
            const __m256 is_nearer =
                _mm256_cmp_ps(_mm256_broadcast_ss(distance2 + j), own, _CMP_LT_OQ);
            rank = _mm256_sub_epi32(rank, _mm256_castps_si256(is_nearer));
        }
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(ranks + i), rank);
    }
}
#else
constexpr bool kHasAvx2 = false;
constexpr auto find_within_avx2 = find_within_plain;
constexpr auto rank_avx2 = rank_plain;
#endif

}  // namespace

std::size_t find_within(const float* x, const float* y, const float* z, std::size_t size,
                        Vec3f from, float bound2, std::uint32_t* places, float* distance2) {
    const auto find = kHasAvx2 ? find_within_avx2 : find_within_plain;
    return find(x, y, z, size, from, bound2, places, distance2);
}

void order_distances(float* distance2, std::size_t size, std::uint32_t* ranks,
                     std::uint32_t* order) {
    std::fill(distance2 + size, distance2 + pad(size), std::numeric_limits<float>::infinity());
    (kHasAvx2 ? rank_avx2 : rank_plain)(distance2, size, ranks);
    // Where some are equal they share a rank and leave the next one free.
    std::size_t sum = 0;
    for (std::size_t i = 0; i < size; ++i) {
        sum += ranks[i];
        order[ranks[i]] = static_cast<std::uint32_t>(i);
    }
    if (sum == size * (size - 1) / 2 || size == 0) return;
    std::iota(order, order + size, 0u);
    std::stable_sort(order, order + size,
                     [&](std::uint32_t a, std::uint32_t b) { return distance2[a] < distance2[b]; });
}

}  // namespace glowworm

#include "octree/links.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "octree/close_patches.h"

namespace glowworm {

namespace {

constexpr std::size_t kLobesAtOnce = 1 << 12;  // between two calls of progress

// Fractions of the plastic number's powers in 1/2^32: R2's steps.
constexpr std::uint32_t kStepU = 3242174889u;
constexpr std::uint32_t kStepV = 2447445414u;

/// Bijective scramble of 32 bits (PCG's output function, Jarzynski and Olano 2020).
std::uint32_t scramble(std::uint32_t value) {
    const std::uint32_t state = value * 747796405u + 2891336453u;
    const std::uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

/// The 24 high bits as a number in [0, 1): exact in float.
float unit_fraction(std::uint32_t fixed) {
    return static_cast<float>(fixed >> 8u) * (1.0f / 16777216.0f);
}

}  // namespace

Vec3f link_direction(std::uint32_t lobe, std::uint32_t ray, const Vec3f& normal) {
    const std::uint32_t seed = scramble(lobe);
    const float u = unit_fraction(seed + (ray + 1u) * kStepU);
    const float v = unit_fraction(scramble(seed) + (ray + 1u) * kStepV);
    const float sine = std::sqrt(u);
    const float angle = 2.0f * std::numbers::pi_v<float> * v;
    // An orthonormal frame without branches at the poles (Duff et al. 2017).
    const float sign = std::copysign(1.0f, normal.z);
    const float a = -1.0f / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    const Vec3f tangent{1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
    const Vec3f bitangent{b, sign + normal.y * normal.y * a, -normal.y};
    return tangent * (sine * std::cos(angle)) + bitangent * (sine * std::sin(angle)) +
           normal * std::sqrt(1.0f - u);
}

std::vector<std::uint32_t> trace_links(const OctreeView& octree, const LinkSettings& settings,
                                       const Progress& progress) {
    const std::vector<Lobe> closed = close_patches(octree);
    OctreeView traced = octree;
    traced.lobes = closed;
    const std::size_t lobes = closed.size();
    const std::size_t rays = settings.rays;
    std::vector<std::uint32_t> links(lobes * rays);
    for (std::size_t begin = 0; begin < lobes; begin += kLobesAtOnce) {
        if (progress) progress(begin, lobes);
        const std::size_t end = std::min(lobes, begin + kLobesAtOnce);
        tbb::parallel_for(tbb::blocked_range(begin, end, 64), [&](const auto& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const Lobe& lobe = closed[i];
                const Vec3f normal = normalized(Vec3f{lobe.ndf[0], lobe.ndf[1], lobe.ndf[2]});
                const auto index = static_cast<std::uint32_t>(i);
                for (std::size_t k = 0; k < rays; ++k) {
                    const Vec3f direction =
                        link_direction(index, static_cast<std::uint32_t>(k), normal);
                    const Ray ray = ray_from_lobe(traced, lobe, direction);
                    links[i * rays + k] = trace_ray(traced, settings.trace, ray).lobe;
                }
            }
        });
    }
    if (progress) progress(lobes, lobes);
    return links;
}

}  // namespace glowworm

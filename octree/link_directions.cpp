#include "octree/link_directions.h"

#include <array>
#include <cmath>
#include <numbers>

#include "octree/wide.h"

namespace glowworm {

namespace {

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
    return static_cast<float>(static_cast<std::int32_t>(fixed >> 8u)) * (1.0f / 16777216.0f);
}

struct Turn {
    float cosine, sine;
};

/// A turn by `fixed` / 2^32 of a whole one.
Turn turn_by(std::uint32_t fixed) {
    const double angle = 2.0 * std::numbers::pi / 4294967296.0 * fixed;
    return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

/// The turns of all lobes' rays before each lobe's own turn.
struct Turns {
    std::array<float, kMostLinks> cosines, sines;

    Turns() {
        for (std::uint32_t ray = 0; ray < kMostLinks; ++ray) {
            const Turn turn = turn_by((ray + 1u) * kStepV);
            cosines[ray] = turn.cosine;
            sines[ray] = turn.sine;
        }
    }
};

const Turns& turns() {
    static const Turns all;
    return all;
}

/// Plain arrays, which the compiler takes several of at once.
GLOWWORM_WIDE void place(const Turns& all, std::uint32_t seed, Turn own, std::size_t count,
                         float* __restrict x, float* __restrict y, float* __restrict z) {
    for (std::size_t ray = 0; ray < count; ++ray) {
        const float u = unit_fraction(seed + (static_cast<std::uint32_t>(ray) + 1u) * kStepU);
        const float sine = std::sqrt(u);
        x[ray] = sine * (own.cosine * all.cosines[ray] - own.sine * all.sines[ray]);
        y[ray] = sine * (own.sine * all.cosines[ray] + own.cosine * all.sines[ray]);
        z[ray] = std::sqrt(1.0f - u);
    }
}

}  // namespace

RaysOfLobe::RaysOfLobe(std::uint32_t lobe, const Vec3f& normal)
    : seed_(scramble(lobe)), normal_(normal) {
    const Turn own = turn_by(scramble(seed_));
    cosine_ = own.cosine;
    sine_ = own.sine;
    // An orthonormal frame without branches at the poles (Duff et al. 2017).
    const float sign = std::copysign(1.0f, normal.z);
    const float a = -1.0f / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    tangent_ = {1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
    bitangent_ = {b, sign + normal.y * normal.y * a, -normal.y};
}

Vec3f RaysOfLobe::direction(std::uint32_t ray) const {
    const Turns& all = turns();
    const float u = unit_fraction(seed_ + (ray + 1u) * kStepU);
    const float sine = std::sqrt(u);
    return tangent_ * (sine * (cosine_ * all.cosines[ray] - sine_ * all.sines[ray])) +
           bitangent_ * (sine * (sine_ * all.cosines[ray] + cosine_ * all.sines[ray])) +
           normal_ * std::sqrt(1.0f - u);
}

void RaysOfLobe::components(std::span<float> x, std::span<float> y, std::span<float> z) const {
    place(turns(), seed_, {cosine_, sine_}, x.size(), x.data(), y.data(), z.data());
}

Vec3f link_direction(std::uint32_t lobe, std::uint32_t ray, const Vec3f& normal) {
    return RaysOfLobe(lobe, normal).direction(ray);
}

}  // namespace glowworm

#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "octree/vec3.h"

namespace glowworm {

// The small encodings of the file: what a shader reads back with unpackSnorm2x16, unpackHalf2x16
// and a few shifts. All round to nearest, ties to even where they can occur.

/// The nearest integer, ties to even, for |v| < 2^22: without a call into the maths library.
inline std::int32_t round_to_int(float v) {
    constexpr float kShift = 12582912.0f;  // 1.5 · 2^23: the unit is the mantissa's last bit
    return std::bit_cast<std::int32_t>(v + kShift) - 0x4b400000;
}

/// Two values in [-1, 1] as 16-bit snorm, x in the low half (GLSL packSnorm2x16).
inline std::uint32_t pack_snorm2x16(float x, float y) {
    const auto one = [](float v) {
        const std::int32_t scaled = round_to_int(std::clamp(v, -1.0f, 1.0f) * 32767.0f);
        return static_cast<std::uint32_t>(static_cast<std::uint16_t>(scaled));
    };
    return one(x) | one(y) << 16;
}

/// A unit vector on the octahedron unfolded to the square (Cigolle et al. 2014). Error below
/// 0.004°.
inline std::uint32_t pack_octahedral(const Vec3f& n) {
    const float scale = 1.0f / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
    float x = n.x * scale;
    float y = n.y * scale;
    if (n.z < 0.0f) {
        const float folded_x = (1.0f - std::abs(y)) * (x < 0.0f ? -1.0f : 1.0f);
        const float folded_y = (1.0f - std::abs(x)) * (y < 0.0f ? -1.0f : 1.0f);
        x = folded_x;
        y = folded_y;
    }
    return pack_snorm2x16(x, y);
}

inline Vec3f unpack_octahedral(std::uint32_t packed) {
    const auto one = [](std::uint32_t half) {
        const auto value = static_cast<std::int16_t>(static_cast<std::uint16_t>(half));
        return std::max(static_cast<float>(value) / 32767.0f, -1.0f);
    };
    Vec3f n{one(packed & 0xffff), one(packed >> 16), 0.0f};
    n.z = 1.0f - std::abs(n.x) - std::abs(n.y);
    if (n.z < 0.0f) {
        const float x = (1.0f - std::abs(n.y)) * (n.x < 0.0f ? -1.0f : 1.0f);
        const float y = (1.0f - std::abs(n.x)) * (n.y < 0.0f ? -1.0f : 1.0f);
        n.x = x;
        n.y = y;
    }
    return normalized(n);
}

/// IEEE 754 binary16; beyond 65504 it saturates instead of becoming infinite, NaN becomes 0.
inline std::uint16_t pack_half(float value) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t sign = bits >> 16 & 0x8000u;
    const std::uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude > 0x7f800000u) return 0;
    if (magnitude >= 0x477ff000u) return static_cast<std::uint16_t>(sign | 0x7bffu);
    if (magnitude < 0x38800000u) {
        // Subnormal: adding 0.5 moves the bits wanted to the end of the mantissa, rounded.
        const float aligned = std::bit_cast<float>(magnitude) + 0.5f;
        return static_cast<std::uint16_t>(sign |
                                          (std::bit_cast<std::uint32_t>(aligned) - 0x3f000000u));
    }
    const std::uint32_t rounded = magnitude + 0xfffu + (magnitude >> 13 & 1u);
    return static_cast<std::uint16_t>(sign | (rounded - 0x38000000u) >> 13);
}

inline float unpack_half(std::uint16_t half) {
    const std::uint32_t sign = (half & 0x8000u) << 16;
    const std::uint32_t rest = half & 0x7fffu;
    if (rest < 0x400u) {
        const float magnitude = static_cast<float>(rest) * 0x1p-24f;
        return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(magnitude));
    }
    const std::uint32_t exponent_shift = rest >= 0x7c00u ? 0x70000000u : 0x38000000u;
    return std::bit_cast<float>(sign | ((rest << 13) + exponent_shift));
}

/// IEC 61966-2-1 transfer function, both in [0, 1].
inline float srgb_to_linear(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

inline float linear_to_srgb(float linear) {
    return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

namespace detail {

/// The 256 linear values, and for each step of 1/4096 the code to start the search at.
struct SrgbTables {
    std::array<float, 256> linear;
    std::array<float, 256> upper;  ///< linear value at which the next code begins
    std::array<std::uint8_t, 4097> start;

    SrgbTables() {
        for (int code = 0; code < 256; ++code) {
            linear[static_cast<std::size_t>(code)] =
                srgb_to_linear(static_cast<float>(code) / 255.0f);
            upper[static_cast<std::size_t>(code)] =
                srgb_to_linear((static_cast<float>(code) + 0.5f) / 255.0f);
        }
        std::uint8_t code = 0;
        for (std::size_t step = 0; step < start.size(); ++step) {
            while (code < 255 && static_cast<float>(step) / 4096.0f >= upper[code])
                ++code;
            start[step] = code;
        }
    }
};

inline const SrgbTables& srgb_tables() {
    static const SrgbTables tables;
    return tables;
}

}  // namespace detail

/// A linear value, clamped to [0, 1], as the nearest of the 256 sRGB codes.
inline std::uint8_t pack_srgb8(float linear) {
    const auto& tables = detail::srgb_tables();
    const float clamped = linear > 0.0f ? std::min(linear, 1.0f) : 0.0f;
    std::uint8_t code = tables.start[static_cast<std::size_t>(clamped * 4096.0f)];
    while (code < 255 && clamped >= tables.upper[code])
        ++code;
    return code;
}

inline float unpack_srgb8(std::uint8_t code) {
    return detail::srgb_tables().linear[code];
}

/// Three non-negative values sharing an exponent (EXT_texture_shared_exponent): red in the low 9
/// bits, the exponent in the high 5. Negative and NaN become 0, beyond 65408 it saturates.
inline std::uint32_t pack_rgb9e5(const Vec3f& colour) {
    const auto bounded = [](float v) { return v > 0.0f ? std::min(v, 65408.0f) : 0.0f; };
    const Vec3f c{bounded(colour.x), bounded(colour.y), bounded(colour.z)};
    const float largest = std::max({c.x, c.y, c.z});
    if (largest == 0.0f) return 0;
    int exponent = std::max(-16, std::ilogb(largest)) + 16;  // biased by 15, plus 1
    if (std::nearbyint(std::ldexp(largest, 24 - exponent)) >= 512.0f) ++exponent;
    const auto mantissa = [&](float v) {
        return static_cast<std::uint32_t>(std::nearbyint(std::ldexp(v, 24 - exponent)));
    };
    return mantissa(c.x) | mantissa(c.y) << 9 | mantissa(c.z) << 18 |
           static_cast<std::uint32_t>(exponent) << 27;
}

inline Vec3f unpack_rgb9e5(std::uint32_t packed) {
    const float scale = std::ldexp(1.0f, static_cast<int>(packed >> 27) - 24);
    return {static_cast<float>(packed & 511) * scale, static_cast<float>(packed >> 9 & 511) * scale,
            static_cast<float>(packed >> 18 & 511) * scale};
}

}  // namespace glowworm

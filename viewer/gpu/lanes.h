#pragma once

// Some pixels' values at once, for topics that are compiled as C++ (viewer/gpu/glsl.h): a topic
// whose functions take FLOATS, or ANY_FLOAT and ANY_VEC3 (gpu_layout.h), then works on that many
// pixels with one instruction each.

#include <cstring>

#include "viewer/gpu/glsl.h"

namespace glowworm::gpu {

inline constexpr int kLanes = 4;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef uint Words __attribute__((vector_size(kLanes * sizeof(uint))));
typedef int Ints __attribute__((vector_size(kLanes * sizeof(int))));  // a comparison's: -1 for true

inline Floats max(Floats a, float b) {
    return a > b ? a : b + Floats{};
}

inline Floats min(Floats a, float b) {
    return a < b ? a : b + Floats{};
}

inline Floats abs(Floats a) {
    return a < 0.0f ? -a : a;
}

inline Floats inversesqrt(Floats a) {
    Floats root{};
    for (int lane = 0; lane < kLanes; ++lane)
        root[lane] = std::sqrt(a[lane]);
    return 1.0f / root;
}

/// e to the power of values in -87..0, to 2e-7 of it: 2^n times a polynomial of what is left.
inline Floats exp(Floats values) {
    const Floats binary = values * 1.44269504f;
    const Ints whole = __builtin_convertvector(binary - 0.5f, Ints);  // rounds, below 0
    const Floats left = (binary - __builtin_convertvector(whole, Floats)) * 0.693147181f;
    const Floats power =
        1.0f +
        left * (1.0f +
                left * (0.5f + left * (1.0f / 6.0f +
                                       left * (1.0f / 24.0f +
                                               left * (1.0f / 120.0f + left * (1.0f / 720.0f))))));
    return power * reinterpret_cast<Floats>((whole + 127) << 23);
}

/// A vec3 of each.
struct Vec3s {
    Floats x, y, z;
    Floats& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
};

inline Vec3s operator+(const Vec3s& a, const Vec3s& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3s operator-(const Vec3s& a, const Vec3s& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3s operator-(const Vec3s& a, const vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3s operator-(const vec3& a, const Vec3s& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3s operator*(Floats a, const Vec3s& b) {
    return {a * b.x, a * b.y, a * b.z};
}
inline Vec3s operator*(Floats a, const vec3& b) {
    return {a * b.x, a * b.y, a * b.z};
}
inline Vec3s& operator+=(Vec3s& a, const Vec3s& b) {
    return a = a + b;
}
inline Vec3s max(const Vec3s& a, const vec3& b) {
    return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
inline Floats dot(const Vec3s& a, const Vec3s& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Floats dot(const Vec3s& a, const vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Floats dot(const vec3& a, const Vec3s& b) {
    return dot(b, a);
}

/// Four floats from memory, wherever they lie.
inline Floats load(const void* four) {
    Floats values;
    std::memcpy(&values, four, sizeof(values));
    return values;
}

inline Ints to_ints(Floats values) {
    return __builtin_convertvector(values, Ints);
}

inline bool any_of(Ints values) {
    typedef long long Longs __attribute__((vector_size(sizeof(Ints))));
    const auto halves = reinterpret_cast<Longs>(values);
    return (halves[0] | halves[1]) != 0;
}

}  // namespace glowworm::gpu

#define FLOATS Floats
#define INTS Ints
#define TO_INTS(values) to_ints(values)

#pragma once

// Some pixels' values at once, for topics that are compiled as C++ (viewer/gpu/glsl.h): a topic
// whose functions take FLOATS then works on that many pixels with one instruction each.

namespace glowworm::gpu {

inline constexpr int kLanes = 4;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef int Ints __attribute__((vector_size(kLanes * sizeof(int))));  // a comparison's: -1 for true

inline Floats max(Floats a, float b) {
    return a > b ? a : b + Floats{};
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

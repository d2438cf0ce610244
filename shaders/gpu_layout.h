// What C++ and GLSL both read. Only 4-byte scalars and vec4: std430 and C++ then agree on offsets.
#ifdef __cplusplus
#pragma once
#include <cstdint>
namespace glowworm::gpu {
using uint = std::uint32_t;
struct vec4 {
    float x = 0.0f, y = 0.0f, z = 0.0f, w = 0.0f;
};
#endif

// One light. Kinds that do not use a field leave it zero.
#define LIGHT_POINT 0u
#define LIGHT_SPOT 1u
#define LIGHT_AREA 2u
struct Light {
    vec4 position;    // xyz: m, relative to the octree's origin (area: the first corner)
    vec4 intensity;   // rgb: W/sr, on the axis for a spot (area: radiance, W/sr/m2)
    vec4 axis;        // xyz: unit direction of a spot, or the normal of an area's emitting side
                      // w: cosine of a spot's half angle
    vec4 edge_u;      // xyz: area: first corner to second, m; w: a spot's blend
    vec4 edge_v;      // xyz: area: first corner to fourth, m
    uint kind;        // LIGHT_*
    uint tag;         // area: what the octree's lobes carry in `light`, 0 where it has none there
    uint unused_0;
    uint unused_1;
};

#ifdef __cplusplus
}  // namespace glowworm::gpu
#endif

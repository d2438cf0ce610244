#ifndef OCTREE_GLSL
#define OCTREE_GLSL
// The octree as it lies in the file, bound for reading.
#include "gpu_layout.h"

#ifndef __cplusplus
struct Node {
    uint mask;
    uint first;
};

struct Lobe {
    float position[3];
    float area;
    float ndf[3];
    float plane_sigma;
    float albedo[3];
    uint light;
    uint patch_min;
    uint patch_max;
    uint emission;
    float spacing;
};

layout(std430, binding = BINDING_NODES) readonly buffer Nodes { Node nodes[]; };
layout(std430, binding = BINDING_LOBES) readonly buffer Lobes { Lobe lobes[]; };
layout(std140, binding = BINDING_LIGHT_GRID) uniform LightGridBlock { LightGrid grid; };
#endif

CONSTANT float kMaxAlbedo = 0.99f;   // above, light in a closed cave would not settle

vec3 cube_min() { return vec3(grid.cube_min_x, grid.cube_min_y, grid.cube_min_z); }

vec3 lobe_position(uint i) {
    return vec3(lobes[i].position[0], lobes[i].position[1], lobes[i].position[2]);
}

// The mean normal: its length is the Toksvig length.
vec3 lobe_ndf(uint i) { return vec3(lobes[i].ndf[0], lobes[i].ndf[1], lobes[i].ndf[2]); }

vec3 lobe_normal(uint i) {
    vec3 n = lobe_ndf(i);
    float l = length(n);
    return l > 0.0f ? n / l : vec3(0.0f, 0.0f, 1.0f);
}

vec3 lobe_albedo(uint i) {
    return vec3(lobes[i].albedo[0], lobes[i].albedo[1], lobes[i].albedo[2]);
}

// A lobe's plane stands for rough rock, of 1 / |ndf| times its area, that lights itself: of what
// enters through the plane, only this share leaves again (a cavity of that opening).
vec3 lobe_reflectance(uint i) {
    vec3 albedo = clamp(lobe_albedo(i), vec3(0.0f), vec3(kMaxAlbedo));
    float opening = min(length(lobe_ndf(i)), 1.0f);
    return albedo * opening / (1.0f - albedo * (1.0f - opening));
}

vec3 unpack_bytes(uint bits) {
    return vec3(bits & 255u, (bits >> 8) & 255u, (bits >> 16) & 255u);
}

// EXT_texture_shared_exponent, red in the low bits.
vec3 unpack_rgb9e5(uint bits) {
    vec3 mantissa = vec3(bits & 511u, (bits >> 9) & 511u, (bits >> 18) & 511u);
    return mantissa * exp2(float(bits >> 27) - 24.0f);
}

// Up to three; seven in the trees of light domains (viewer/light/domains.h).
uint lobes_of_leaf(uint mask) { return (mask >> 8) & 7u; }
#endif

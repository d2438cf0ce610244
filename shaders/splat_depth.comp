#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "rims.glsl"
#ifdef BEHIND_RIMS
#define DISC_REACH kGapGrowth
#endif
#include "view.glsl"
#include "surfel.glsl"
#include "splat.glsl"
#include "splat_input.glsl"

// The nearest disc at each pixel: the bits of a positive float keep its order. With BEHIND_RIMS, the
// nearest behind the rims that rim_find.comp found, and the nearest grown one where it found gaps.
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };

#ifdef BEHIND_RIMS
layout(std430, binding = BINDING_RIMS) readonly buffer pixel_rims { float rims[]; };
const float kBehind = 2.0;   // radii: nearer, a disc may stick out of a surface that the rim ends at
bool counts(uint pixel, float depth, float off, float radius) {
    float rim = rims[pixel];
    if (rim == kGap) return off < kGapGrowth * kGapGrowth;
    return rim > 0.0 && off < 1.0 && depth - rim > kBehind * radius;
}
#include "rim_tiles.glsl"
#else
bool any_rim(Splat splat) { return true; }
bool counts(uint pixel, float depth, float off, float radius) { return off < 1.0; }
#endif

void main() {
    PackedSurfel surfel;
    Splat splat;
    if (!this_splat(surfel, splat) || !any_rim(splat)) return;

    for (int y = splat.lowest.y; y <= splat.highest.y; ++y) {
        for (int x = splat.lowest.x; x <= splat.highest.x; ++x) {
            float depth, off;
            if (!splat_at(splat, ivec2(x, y), depth, off)) continue;
            uint pixel = uint(y) * view.width + uint(x);
            if (!counts(pixel, depth, off, splat.radius)) continue;
            uint bits = floatBitsToUint(depth);
            if (bits < depths[pixel]) atomicMin(depths[pixel], bits);
        }
    }
}

#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surfel.glsl"
#include "splat.glsl"
#include "splat_input.glsl"
#include "surface_sums.glsl"

layout(std430, binding = BINDING_DEPTHS) readonly buffer pixel_depths { uint depths[]; };

// Discs within one radius behind the nearest one belong to the same surface and are averaged. With
// BEHIND_RIMS, only where one was found behind a rim.
#ifdef BEHIND_RIMS
layout(std430, binding = BINDING_RIMS) readonly buffer pixel_rims { float rims[]; };
bool counts(uint pixel, float behind, float radius) {
    return rims[pixel] > 0.0 && behind > -0.01 * radius;   // the rim itself lies farther in front
}
#include "rim_tiles.glsl"
#else
bool any_rim(Splat splat) { return true; }
bool counts(uint pixel, float behind, float radius) { return true; }
#endif

void main() {
    PackedSurfel surfel;
    Splat splat;
    if (!this_splat(surfel, splat) || !any_rim(splat)) return;
    vec3 normal = camera_from_octree_direction(surfel_normal(surfel));
    vec3 albedo = surfel_albedo(surfel);
    float ndf_length = surfel_ndf_length(surfel);

    for (int y = splat.lowest.y; y <= splat.highest.y; ++y) {
        for (int x = splat.lowest.x; x <= splat.highest.x; ++x) {
            float depth, weight;
            if (!splat_at(splat, ivec2(x, y), depth, weight)) continue;
            uint pixel = uint(y) * view.width + uint(x);
            float behind = depth - uintBitsToFloat(depths[pixel]);
            if (behind > splat.radius || !counts(pixel, behind, splat.radius)) continue;
            add_to_surface(pixel, weight, normal, albedo, ndf_length, behind);
        }
    }
}

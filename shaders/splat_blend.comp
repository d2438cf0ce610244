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
#include "surface_sums.glsl"

layout(std430, binding = BINDING_DEPTHS) readonly buffer pixel_depths { uint depths[]; };

// Discs within one radius behind the nearest one belong to the same surface and are averaged. With
// BEHIND_RIMS, only where one was found behind a rim or in a gap.
#ifdef BEHIND_RIMS
layout(std430, binding = BINDING_RIMS) readonly buffer pixel_rims { float rims[]; };
// How far off its middle squared a disc counts, 0 where it does not.
float reach_at(uint pixel, float behind, float radius) {
    if (rims[pixel] == kGap) return kGapGrowth * kGapGrowth;
    return rims[pixel] > 0.0 && behind > -0.01 * radius ? 1.0 : 0.0;   // the rim lies farther in front
}
#include "rim_tiles.glsl"
#else
bool any_rim(Splat splat) { return true; }
float reach_at(uint pixel, float behind, float radius) { return 1.0; }
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
            float depth, off;
            if (!splat_at(splat, ivec2(x, y), depth, off)) continue;
            uint pixel = uint(y) * view.width + uint(x);
            float behind = depth - uintBitsToFloat(depths[pixel]);
            float most = reach_at(pixel, behind, splat.radius);
            if (behind > splat.radius || off >= most) continue;
            add_to_surface(pixel, splat_weight(off, most), normal, albedo, ndf_length, behind);
        }
    }
}

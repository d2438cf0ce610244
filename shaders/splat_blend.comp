#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surfel.glsl"
#include "rims.glsl"
#include "splat.glsl"
#include "surface_sums.glsl"
#include "splat_input.glsl"
#include "pixel_sums.glsl"

layout(std430, binding = BINDING_DEPTHS) readonly buffer pixel_depths { uint depths[]; };

// Discs within one radius behind the nearest one belong to the same surface and are averaged. With
// BEHIND_RIMS, only where one was found behind a rim or in a gap.
#ifdef BEHIND_RIMS
layout(std430, binding = BINDING_RIMS) readonly buffer pixel_rims { float rims[]; };
#include "rim_tiles.glsl"
const float kReach = kGapGrowth;
#define REACH_AT(pixel, behind, radius) reach_beside(rims[pixel], behind, radius)
#else
const float kReach = 1.0;
bool any_rim(ivec4 box) { return true; }
#define REACH_AT(pixel, behind, radius) 1.0
#endif

void main() {
    PackedSurfel surfel;
    Splat splat;
    vec3 normal;
    if (!this_splat(surfel, splat, normal)) return;
    ivec4 box = splat_box(splat, kReach);
    if (is_empty_box(box) || !any_rim(box)) return;
    vec3 albedo = surfel_albedo(surfel);
    float ndf_length = surfel_ndf_length(surfel);

    for (int y = box.y; y <= box.w; ++y) {
        for (int x = box.x; x <= box.z; ++x) {
            uint pixel = uint(y) * view.width + uint(x);
            float depth, off;
            splat_at(splat, float(x) + 0.5, float(y) + 0.5, depth, off);
            float behind = depth - uintBitsToFloat(depths[pixel]);
            float most = REACH_AT(pixel, behind, splat.radius);
            if (depth <= 0.0 || behind > splat.radius || off >= most) continue;
            add_to_surface(pixel, share_of_surface(splat_weight(off, most), normal, albedo,
                                                   ndf_length, behind));
        }
    }
}

#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surfel.glsl"
#include "rims.glsl"
#include "splat.glsl"
#include "splat_input.glsl"

// The nearest disc at each pixel: the bits of a positive float keep its order. With BEHIND_RIMS, the
// nearest behind the rims that rim_find.comp found, and the nearest grown one where it found gaps.
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };

#ifdef BEHIND_RIMS
layout(std430, binding = BINDING_RIMS) readonly buffer pixel_rims { float rims[]; };
#include "rim_tiles.glsl"
const float kReach = kGapGrowth;
#define REACH_AT(pixel, depth, radius) reach_behind(rims[pixel], depth, radius)
#else
const float kReach = 1.0;
bool any_rim(ivec4 box) { return true; }
#define REACH_AT(pixel, depth, radius) 1.0
layout(std430, binding = BINDING_DEPTH_TILES) buffer depth_tiles { uint tiles[]; };

// Keeps how wide the widest disc is that touches a square, behind the depths of the pyramid's squares.
void note_width(ivec4 box) {
    uvec2 size = uvec2(view.width, view.height);
    uvec2 depths_there = (size + DEPTH_TILE - 1u) / DEPTH_TILE;
    uint columns = (view.width + WIDTH_TILE - 1u) / WIDTH_TILE;
    uint width = uint(max(box.z - box.x, box.w - box.y) + 1);
    for (int y = box.y / WIDTH_TILE; y <= box.w / WIDTH_TILE; ++y) {
        for (int x = box.x / WIDTH_TILE; x <= box.z / WIDTH_TILE; ++x) {
            uint at = depths_there.x * depths_there.y + uint(y) * columns + uint(x);
            if (width > tiles[at]) atomicMax(tiles[at], width);
        }
    }
}
#endif

void main() {
    PackedSurfel surfel;
    Splat splat;
    vec3 normal;
    if (!this_splat(surfel, splat, normal)) return;
    ivec4 box = splat_box(splat, kReach);
    if (is_empty_box(box) || !any_rim(box)) return;
#ifndef BEHIND_RIMS
    note_width(box);
#endif

    for (int y = box.y; y <= box.w; ++y) {
        for (int x = box.x; x <= box.z; ++x) {
            uint pixel = uint(y) * view.width + uint(x);
            float depth, off;
            splat_at(splat, float(x) + 0.5, float(y) + 0.5, depth, off);
            if (depth <= 0.0 || off >= REACH_AT(pixel, depth, splat.radius)) continue;
            uint bits = floatBitsToUint(depth);
            if (bits < depths[pixel]) atomicMin(depths[pixel], bits);
        }
    }
}

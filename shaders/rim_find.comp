#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surface_sums.glsl"

// Pixels that only the outer parts of discs reach: the surface's edge is nearer to their centres.
layout(local_size_x = 128) in;
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };
layout(std430, binding = BINDING_RIMS) writeonly buffer pixel_rims { float rims[]; };   // depth, or 0

layout(std430, binding = BINDING_RIM_TILES) writeonly buffer rim_tiles { uint tiles[]; };   // 1: holds a rim

// Sum of weights of a rim. Inside a surface of random points it is 1.8 in the mean (splat scale 3).
const float kRimCover = 0.04;

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint pixel = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (pixel >= view.width * view.height) return;

    int weight = normal_sums[pixel].w;
    bool rim = weight > 0 && float(weight) < kRimCover * kFixedOne;
    rims[pixel] = rim ? uintBitsToFloat(depths[pixel]) : 0.0;
    if (rim) {
        depths[pixel] = kFarthest;
        uint columns = (view.width + RIM_TILE - 1u) / RIM_TILE;
        tiles[pixel / view.width / RIM_TILE * columns + pixel % view.width / RIM_TILE] = 1u;
    }
}

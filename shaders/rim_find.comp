#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "rims.glsl"
#include "surface_sums.glsl"
#include "pixel_sums.glsl"

layout(local_size_x = 128) in;
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };
layout(std430, binding = BINDING_RIMS) writeonly buffer pixel_rims { float rims[]; };
layout(std430, binding = BINDING_RIM_TILES) writeonly buffer rim_tiles { uint tiles[]; };   // 1: holds a rim

bool is_solid(uint pixel) { return float(normal_sums[pixel].w) >= kRimCover * kFixedOne; }
float depth_at(uint pixel) { return uintBitsToFloat(depths[pixel]); }
#include "rim_search.glsl"

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint pixel = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (pixel >= view.width * view.height) return;

    float rim = is_solid(pixel) ? 0.0
                                : find_rim(ivec2(pixel % view.width, pixel / view.width),
                                           normal_sums[pixel].w > 0 ? depth_at(pixel) : 0.0);
    rims[pixel] = rim;
    if (rim > 0.0) {
        depths[pixel] = kFarthest;
        uint columns = (view.width + RIM_TILE - 1u) / RIM_TILE;
        tiles[pixel / view.width / RIM_TILE * columns + pixel % view.width / RIM_TILE] = 1u;
    }
}

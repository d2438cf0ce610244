#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "rims.glsl"
#include "surface_sums.glsl"
#include "pixel_sums.glsl"

layout(local_size_x = 128) in;
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };
layout(std430, binding = BINDING_RIMS) readonly buffer pixel_rims { float rims[]; };

float rim_at(uint pixel) { return rims[pixel]; }
bool is_empty(uint pixel) { return depths[pixel] == kFarthest; }
#include "rim_borders.glsl"

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint pixel = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (pixel >= view.width * view.height || rims[pixel] <= 0.0) return;

    clear_surface(pixel);
    if (keeps_rim(pixel, ivec2(pixel % view.width, pixel / view.width))) {
        depths[pixel] = floatBitsToUint(rims[pixel]);
    }
}

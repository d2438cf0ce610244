#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surface_sums.glsl"

// A rim with something behind it gives way to that; without, it stays: better than a hole.
layout(local_size_x = 128) in;
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };
layout(std430, binding = BINDING_RIMS) buffer pixel_rims { float rims[]; };

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint pixel = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (pixel >= view.width * view.height || rims[pixel] <= 0.0) return;

    if (depths[pixel] == kFarthest) {
        depths[pixel] = floatBitsToUint(rims[pixel]);
        rims[pixel] = 0.0;
    } else {
        clear_surface(pixel);
    }
}

#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "tone_curve.glsl"

// A sparse grid of the picture's luminances, for exposure. -1 where nothing was hit.
layout(local_size_x = 64) in;
layout(std430, binding = BINDING_PIXEL_BEAUTY) readonly buffer pixel_beauty { vec4 beauty[]; };
layout(std430, binding = BINDING_LUMINANCES) writeonly buffer sparse_luminances { float luminances[]; };
layout(location = 0) uniform uint width;        // pixels
layout(location = 1) uniform uint sample_count;

void main() {
    uint i = gl_WorkGroupID.y * gl_NumWorkGroups.x * 64u + gl_GlobalInvocationID.x;
    if (i >= sample_count) return;
    uint columns = width / LUMINANCE_STRIDE;
    uint x = (i % columns) * LUMINANCE_STRIDE + LUMINANCE_STRIDE / 2;
    uint y = (i / columns) * LUMINANCE_STRIDE + LUMINANCE_STRIDE / 2;
    vec4 color = beauty[y * width + x];
    luminances[i] = color.a > 0.0 ? luminance(color.rgb) : -1.0;
}

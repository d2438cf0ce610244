#version 450
#extension GL_GOOGLE_include_directive : require
// Light spread over the surface, of a block of lobes.
#include "smoothing.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_lobe;
layout(location = 1) uniform uint last_lobe;
layout(std430, binding = BINDING_SCRATCH_B) writeonly buffer Smoothed { LobeLight smoothed[]; };

void main() {
    uint i = first_lobe + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= last_lobe) return;
    smoothed[i] = smoothed_light(i);
}

#version 450
#extension GL_GOOGLE_include_directive : require
// A lobe's rays are few and its neighbours have others: their noise is spread over the surface
// within two leaves, each lobe's light turned to the normal it is carried to.
#include "light_lookup.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_lobe;
layout(location = 1) uniform uint last_lobe;
layout(std430, binding = BINDING_SCRATCH_B) writeonly buffer Smoothed { LobeLight smoothed[]; };

const float kSmoothing = 2.0;   // width of the kernel, in those of the lookup's

void main() {
    uint i = first_lobe + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= last_lobe) return;
    LobeLight light = light_around(lobe_position(i), lobe_normal(i), kSmoothing, true);
    for (int c = 0; c < 3; ++c) light.turn[c].w = lobe_lights[i].turn[c].w;
    smoothed[i] = light;
}

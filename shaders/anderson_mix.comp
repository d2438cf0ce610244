#version 450
#extension GL_GOOGLE_include_directive : require
// The next iterate: T(x) less its part along earlier iterates' changes. With all weights zero it is
// the plain bounce.
#include "octree.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform vec3 weights;
layout(location = 1) uniform uint slots[4];   // newest first
layout(location = 5) uniform uint count;   // of what the iterates are made of
layout(std430, binding = BINDING_INDIRECT) writeonly buffer Indirect { vec4 indirect_field[]; };
layout(std430, binding = BINDING_SCRATCH_B) readonly buffer Gathered { vec4 gathered[]; };   // T(x)
layout(std430, binding = BINDING_SCRATCH_C) buffer History { vec4 past[]; };   // T(x) by slot

const float kMost = 1e30;

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= count) return;
    vec3 now = gathered[i].rgb;
    vec3 next = now;
    for (int j = 0; j < 3; ++j) {
        if (weights[j] != 0.0) {
            next -= weights[j] * (now - past[slots[j + 1] * count + i].rgb);
        }
    }
    past[slots[0] * count + i] = vec4(now, 0.0);
    indirect_field[i] = vec4(clamp(next, vec3(0.0), vec3(kMost)), 0.0);
}

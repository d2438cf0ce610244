#version 450
#extension GL_GOOGLE_include_directive : require
// The light meter at surface points: indirect irradiance.
#include "light_lookup.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint probe_count;
// Per probe: position, normal.
layout(std430, binding = BINDING_SCRATCH_A) readonly buffer Probes { vec4 probes[]; };
// Per probe: direct, indirect irradiance.
layout(std430, binding = BINDING_SCRATCH_B) buffer Measured { vec4 measured[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= probe_count) return;
    measured[2u * i + 1u] = indirect_light(probes[2u * i].xyz, probes[2u * i + 1u].xyz);
}

#version 450
#extension GL_GOOGLE_include_directive : require
// The light meter: direct and indirect irradiance at surface points.
#define AREA_SAMPLES 16
#include "direct_light.glsl"
#include "light_lookup.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint probe_count;
layout(std430, binding = BINDING_SCRATCH_A) readonly buffer Probes { vec4 probes[]; };     // position, normal
layout(std430, binding = BINDING_SCRATCH_B) writeonly buffer Measured { vec4 measured[]; };// direct, indirect

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= probe_count) return;
    vec3 position = probes[2u * i].xyz;
    vec3 normal = probes[2u * i + 1u].xyz;
    measured[2u * i] = vec4(direct_irradiance(position, normal), 0.0);
    measured[2u * i + 1u] = vec4(indirect_irradiance(position, normal), 0.0);
}

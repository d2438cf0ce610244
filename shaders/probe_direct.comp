#version 450
#extension GL_GOOGLE_include_directive : require
// The light meter at surface points: the part of direct irradiance that comes from one light's rows
// of samples, added to what is there.
#define AREA_SAMPLES AREA_SAMPLES_OF_PROBE
#include "direct_light.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint probe_count;
layout(location = 1) uniform uint light;
layout(location = 2) uniform int first_row;
layout(location = 3) uniform int last_row;
// Per probe: position, normal.
layout(std430, binding = BINDING_SCRATCH_A) readonly buffer Probes { vec4 probes[]; };
// Per probe: direct, indirect irradiance.
layout(std430, binding = BINDING_SCRATCH_B) buffer Measured { vec4 measured[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= probe_count) return;
    measured[2u * i].rgb +=
        direct_irradiance_of(light, probes[2u * i].xyz, probes[2u * i + 1u].xyz,
                             kPointOffset * grid.voxel_size, first_row, last_row);
}

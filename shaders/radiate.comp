#version 450
#extension GL_GOOGLE_include_directive : require
// Outgoing radiance of every lobe.
#include "radiate.glsl"

layout(local_size_x = 64) in;
layout(std430, binding = BINDING_DIRECT) readonly buffer Direct { vec4 direct_field[]; };
layout(std430, binding = BINDING_INDIRECT) readonly buffer Indirect { vec4 indirect_field[]; };
layout(std430, binding = BINDING_RADIANCE) writeonly buffer Radiance { vec4 radiance_field[]; };
layout(std430, binding = BINDING_SCRATCH_A) readonly buffer Emitted { vec4 emitted[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= grid.lobe_count) return;
    vec3 arriving = direct_field[i].rgb + indirect_field[i].rgb;
    radiance_field[i] = vec4(lobe_radiance(i, emitted[i].rgb, arriving), 0.0);
}

#version 450
#extension GL_GOOGLE_include_directive : require
// Outgoing radiance of every lobe: what it emits and what it reflects of the light it gets
// (L = Le + albedo/pi (E_direct + E_indirect), re-evaluated, never added up).
#include "octree.glsl"

layout(local_size_x = 64) in;
layout(std430, binding = BINDING_DIRECT) readonly buffer Direct { vec4 direct_field[]; };
layout(std430, binding = BINDING_INDIRECT) readonly buffer Indirect { vec4 indirect_field[]; };
layout(std430, binding = BINDING_RADIANCE) writeonly buffer Radiance { vec4 radiance_field[]; };
layout(std430, binding = BINDING_SCRATCH_A) readonly buffer Emitted { vec4 emitted[]; };

const float kInversePi = 0.31830988618;

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= grid.lobe_count) return;
    vec3 arriving = direct_field[i].rgb + indirect_field[i].rgb;
    bool faithful = (grid.flags & LIGHT_FLAG_FAITHFUL) != 0u;
    vec3 reflected = faithful ? clamp(lobe_albedo(i), vec3(0.0), vec3(kMaxAlbedo))
                              : lobe_reflectance(i);
    radiance_field[i] = vec4(emitted[i].rgb + reflected * kInversePi * arriving, 0.0);
}

#version 450
#extension GL_GOOGLE_include_directive : require
// Direct light of one light at every lobe, added to what is there.
#include "direct_light.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_lobe;
layout(location = 1) uniform uint last_lobe;
layout(location = 2) uniform uint light;
layout(std430, binding = BINDING_DIRECT) buffer Direct { vec4 direct_field[]; };

void main() {
    uint i = first_lobe + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= last_lobe) return;
    direct_field[i].rgb += direct_irradiance_of_lobe(light, i);
}

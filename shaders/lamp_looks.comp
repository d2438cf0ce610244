#version 450
#extension GL_GOOGLE_include_directive : require
// Whether lobes see one lamp.
#include "lamp_looks.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_lobe;
layout(location = 1) uniform uint last_lobe;
layout(location = 2) uniform uint lamp;
layout(std430, binding = BINDING_LAMP_LOOKS) buffer LampLooks { uvec2 lamp_looks[]; };

void main() {
    uint lobe = first_lobe + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
                gl_LocalInvocationID.x;
    if (lobe >= last_lobe) return;
    lamp_looks[lamp / LAMPS_IN_GROUP * grid.lobe_count + lobe] |= look_at_lamp(lobe, lamp);
}

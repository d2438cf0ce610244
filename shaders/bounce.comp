#version 450
#extension GL_GOOGLE_include_directive : require
// One bounce: indirect irradiance of a block of lobes as the mean of what their links radiate.
#include "octree.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_lobe;
layout(location = 1) uniform uint last_lobe;
layout(location = 2) uniform uint rays;   // of each row's links_per_lobe, the first so many
layout(std430, binding = BINDING_RADIANCE) readonly buffer Radiance { vec4 radiance_field[]; };
layout(std430, binding = BINDING_LINKS) readonly buffer Links { uint links[]; };
layout(std430, binding = BINDING_SCRATCH_B) writeonly buffer Gathered { vec4 gathered[]; };

const float kPi = 3.14159265359;

void main() {
    uint i = first_lobe + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= last_lobe) return;
    uint row = (i - first_lobe) * grid.links_per_lobe;
    vec3 sum = vec3(0.0);
    uint open_rays = 0u;   // a buried one says nothing
    for (uint ray = 0u; ray < rays; ++ray) {
        uint link = links[row + ray];
        if (link < grid.lobe_count) sum += radiance_field[link].rgb;
        if (link != BURIED) ++open_rays;
    }
    gathered[i] = vec4(sum * (kPi / float(max(open_rays, 1u))), 0.0);
}

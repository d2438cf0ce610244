#version 450
#extension GL_GOOGLE_include_directive : require
// What the lookup needs of a block of lobes once bounces are done: their irradiance, and how it
// changes as the surface turns, from the same links (Ward and Heckbert 1992, Irradiance Gradients).
// With no rays (light came by cones) it does not change.
#include "octree.glsl"
#include "link_direction.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_lobe;
layout(location = 1) uniform uint last_lobe;
layout(location = 2) uniform uint rays;
layout(std430, binding = BINDING_INDIRECT) readonly buffer Indirect { vec4 indirect_field[]; };
layout(std430, binding = BINDING_RADIANCE) readonly buffer Radiance { vec4 radiance_field[]; };
layout(std430, binding = BINDING_LINKS) readonly buffer Links { uint links[]; };
layout(std430, binding = BINDING_SCRATCH_B) buffer Published { LobeLight lobe_lights[]; };

const float kPi = 3.14159265359;
const float kLeastCosine = 0.1;   // the tangent of a grazing ray is bounded, or it would be noise

void main() {
    uint i = first_lobe + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= last_lobe) return;
    uint row = (i - first_lobe) * grid.links_per_lobe;
    vec3 normal = lobe_normal(i);
    mat3 turn = mat3(0.0);   // a column per channel
    uint open_rays = 0u;
    for (uint ray = 0u; ray < rays; ++ray) {
        uint link = links[row + ray];
        if (link != BURIED) ++open_rays;
        if (link >= grid.lobe_count) continue;
        vec3 direction = link_direction(i, ray, normal);
        float cosine = dot(direction, normal);
        turn += outerProduct((direction - cosine * normal) / max(cosine, kLeastCosine),
                             radiance_field[link].rgb);
    }
    turn *= kPi / float(max(open_rays, 1u));
    lobe_lights[i].irradiance = vec4(indirect_field[i].rgb, lobe_lights[i].irradiance.w);
    for (int c = 0; c < 3; ++c) {
        lobe_lights[i].turn[c] = vec4(turn[c], kPi * radiance_field[i][c]);
    }
}

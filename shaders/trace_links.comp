#version 450
#extension GL_GOOGLE_include_directive : require
// The lobe that each gather ray meets: the twin of octree/links.cpp.
#include "trace.glsl"
#include "link_direction.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_lobe;
layout(location = 1) uniform uint last_lobe;
layout(location = 2) uniform uint first_ray;
layout(location = 3) uniform uint last_ray;
// One block of lobes: the first link is that of first_lobe.
layout(std430, binding = BINDING_LINKS) writeonly buffer Links { uint links[]; };

void main() {
    uint i = first_lobe + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= last_lobe) return;
    vec3 normal = lobe_normal(i);
    float offset = max(kLeastOffset * grid.voxel_size, kSigmasOff * lobes[i].plane_sigma);
    vec3 origin = lobe_position(i) + normal * offset;
    uint row = (i - first_lobe) * grid.links_per_lobe;
    for (uint ray = first_ray; ray < last_ray; ++ray) {
        links[row + ray] = trace_ray(origin, link_direction(i, ray, normal), normal,
                                     kLeastDistance * grid.voxel_size, 1e30);
    }
}

#version 450
#extension GL_GOOGLE_include_directive : require
// Leaves as cones see them. The paper's are isotropic, one opaque voxel however little surface it
// holds; ours have an optical depth per side from the surface that faces it (light.md, 3.0).
#define SIDES_ACCESS writeonly
#include "sides.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_node;
layout(location = 1) uniform uint node_count;
layout(std430, binding = BINDING_RADIANCE) readonly buffer Radiance { vec4 radiance_field[]; };

const float kDepthPerCoverage = 4.0;   // optical depth of a voxel whose cross-section is covered once

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= node_count) return;
    Node leaf = nodes[first_node + i];
    bool faithful = (grid.flags & LIGHT_FLAG_FAITHFUL) != 0u;
    for (int side = 0; side < 6; ++side) {
        vec3 facing = vec3(0.0);
        facing[side / 2] = (side & 1) == 0 ? 1.0 : -1.0;
        float depth = 0.0;          // optical depth, or under faithful the area
        vec3 radiance = vec3(0.0);  // weighted with it
        for (uint k = leaf.first; k < leaf.first + lobes_of_leaf(leaf.mask); ++k) {
            float weight = lobes[k].area;
            if (!faithful) {
                vec3 n = lobe_ndf(k);
                vec3 along = abs(lobe_normal(k));
                float coverage = weight * (along.x + along.y + along.z) /
                                 (grid.voxel_size * grid.voxel_size);
                float spread = 0.5 * (1.0 - min(length(n), 1.0));
                weight = kDepthPerCoverage * coverage * (max(dot(n, facing), 0.0) + spread);
            }
            depth += weight;
            radiance += weight * radiance_field[k].rgb;
        }
        float opacity = faithful ? kMostOpacity : min(1.0 - exp(-depth), kMostOpacity);
        vec3 mean = depth > 0.0 ? radiance / depth : vec3(0.0);
        sides[6u * (first_node + i) + uint(side)] = pack_side(vec4(mean * opacity, opacity));
    }
}

#version 450
#extension GL_GOOGLE_include_directive : require
// Indirect irradiance of a block of lobes by cones over the hemisphere round their mean normal.
#include "cone.glsl"
#include "link_direction.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_lobe;
layout(location = 1) uniform uint last_lobe;
layout(location = 2) uniform uint cone_count;
// Per cone: x: sin^2 of its angle to the normal, y: azimuth in turns, z: spread, w: weight.
layout(location = 3) uniform vec4 cones[16];
layout(std430, binding = BINDING_SCRATCH_B) writeonly buffer Gathered { vec4 gathered[]; };

const float kPi = 3.14159265359;
const float kStartOffset = 0.25;   // leaf edges off the lobe, clipped by its tangent plane

void main() {
    uint i = first_lobe + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= last_lobe) return;
    bool faithful = (grid.flags & LIGHT_FLAG_FAITHFUL) != 0u;
    vec3 normal = lobe_normal(i);
    vec3 position = lobe_position(i);
    float h = grid.voxel_size;
    if (faithful) {   // the voxel's centre, one voxel off
        position = cube_min() + (floor((position - cube_min()) / h) + 0.5) * h + normal * h;
    } else {
        position += normal * (kStartOffset * h);
    }
    float turn = faithful ? 0.0 : unit_fraction(scramble(i));
    vec3 sum = vec3(0.0);
    for (uint k = 0u; k < cone_count; ++k) {
        Cone cone;
        cone.origin = position;
        cone.direction = cosine_direction(cones[k].x, cones[k].y + turn, normal);
        cone.plane_normal = normal;
        cone.spread = cones[k].z;
        cone.start = h;
        sum += cones[k].w * trace_cone(cone, faithful);
    }
    gathered[i] = vec4(kPi * sum, 0.0);
}

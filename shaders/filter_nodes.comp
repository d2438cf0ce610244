#version 450
#extension GL_GOOGLE_include_directive : require
// One level of inner nodes from their children: for each side the pairs of children along its axis
// are composited front to back, and the four pairs averaged.
#define SIDES_ACCESS
#include "sides.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint first_node;
layout(location = 1) uniform uint node_count;

vec4 child_side(Node node, uint octant, int side) {
    if (((node.mask >> octant) & 1u) == 0u) return vec4(0.0);
    uint child = node.first + uint(bitCount(node.mask & ((1u << octant) - 1u)));
    return unpack_side(sides[6u * child + uint(side)]);
}

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= node_count) return;
    Node node = nodes[first_node + i];
    for (int side = 0; side < 6; ++side) {
        uint axis_bit = 1u << (side / 2);
        vec4 sum = vec4(0.0);
        for (uint octant = 0u; octant < 8u; ++octant) {
            if ((octant & axis_bit) != 0u) continue;
            vec4 low = child_side(node, octant, side);
            vec4 high = child_side(node, octant | axis_bit, side);
            vec4 front = (side & 1) == 0 ? high : low;
            vec4 back = (side & 1) == 0 ? low : high;
            sum += front + (1.0 - front.a) * back;
        }
        sides[6u * (first_node + i) + uint(side)] = pack_side(0.25 * sum);
    }
}

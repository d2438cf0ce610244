#ifndef SIDES_GLSL
#define SIDES_GLSL
// A node as seen from its six sides: premultiplied radiance and opacity, four halves each. Side
// 2 * axis is seen by who looks along -axis (it faces +axis), 2 * axis + 1 by who looks along +axis.
#include "octree.glsl"

vec4 unpack_side(uvec2 bits) {
    return vec4(unpackHalf2x16(bits.x), unpackHalf2x16(bits.y));
}

#ifndef __cplusplus
#ifndef SIDES_ACCESS
#define SIDES_ACCESS readonly
#endif
layout(std430, binding = BINDING_SIDES) SIDES_ACCESS buffer Sides { uvec2 sides[]; };
layout(std430, binding = BINDING_DENSE) readonly buffer Dense { uint dense[]; };

const float kMostOpacity = 0.99;
const float kMostRadiance = 60000.0;   // a half holds 65504

// Opacity and radiance are clamped together, so that no path through the tree gains energy.
uvec2 pack_side(vec4 side) {
    if (side.a > kMostOpacity) side *= kMostOpacity / side.a;
    side.rgb = min(side.rgb, vec3(kMostRadiance));
    return uvec2(packHalf2x16(side.rg), packHalf2x16(side.ba));
}
#endif

// The node of a cell at `level`, NO_HIT where it is empty or outside.
uint node_at(ivec3 cell, int level) {
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(1 << level)))) {
        return NO_HIT;
    }
    int start = min(level, DENSE_LEVELS);
    ivec3 coarse = cell >> (level - start);
    uint first = ((1u << (3 * start)) - 1u) / 7u;
    uint node = dense[first + uint(coarse.x | (coarse.y << start) | (coarse.z << (2 * start)))];
    for (int l = start; l < level && node != NO_HIT; ++l) {
        ivec3 bit = (cell >> (level - l - 1)) & 1;
        uint octant = uint(bit.x | (bit.y << 1) | (bit.z << 2));
        Node parent = nodes[node];
        node = ((parent.mask >> octant) & 1u) == 0u
                   ? NO_HIT
                   : parent.first + uint(bitCount(parent.mask & ((1u << octant) - 1u)));
    }
    return node;
}
#endif

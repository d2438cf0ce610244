#ifndef LIGHT_LOOKUP_GLSL
#define LIGHT_LOOKUP_GLSL
// Light between the lobes: sums over the leaves round a point, divided by the weights of those that
// are there, so that empty cells neither darken nor brighten. Lobes count by (n . n_lobe)^4 and
// those facing away not at all: the two sides of a thin wall stay apart.
#include "octree.glsl"

layout(std430, binding = BINDING_INDIRECT) readonly buffer Indirect { vec4 indirect_field[]; };

const int kLookupStack = 96;   // 7 siblings wait on each level at most, 14 levels

// Weight of a leaf whose centre lies `d` leaf edges away along one axis.
float lookup_weight(float d, bool tricubic) {
    d = abs(d);
    if (!tricubic) return max(1.0 - d, 0.0);
    if (d >= 2.0) return 0.0;
    float r = 2.0 - d;
    return d >= 1.0 ? r * r * r / 6.0 : (4.0 - 6.0 * d * d + 3.0 * d * d * d) / 6.0;
}

// Irradiance that was reflected at least once, W/m2, at a surface point.
vec3 indirect_irradiance(vec3 position, vec3 normal) {
    bool tricubic = (grid.flags & LIGHT_FLAG_TRICUBIC) != 0u;
    int depth = int(grid.depth);
    vec3 at = (position - cube_min()) / grid.voxel_size - 0.5;   // leaf centres at whole numbers
    int reach = tricubic ? 2 : 1;
    ivec3 low = ivec3(floor(at)) - (reach - 1);
    ivec3 high = low + 2 * reach - 1;

    uint stack_node[kLookupStack];
    uvec2 stack_cell[kLookupStack];   // x: 16 bits x, 16 bits y; y: 16 bits z, 16 bits level
    int top = 1;
    stack_node[0] = 0u;
    stack_cell[0] = uvec2(0u);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    while (top > 0) {
        --top;
        Node node = nodes[stack_node[top]];
        uvec2 place = stack_cell[top];
        ivec3 cell = ivec3(place.x & 0xffffu, place.x >> 16, place.y & 0xffffu);
        int level = int(place.y >> 16);
        if (level == depth) {
            vec3 d = vec3(cell) - at;
            float w = lookup_weight(d.x, tricubic) * lookup_weight(d.y, tricubic) *
                      lookup_weight(d.z, tricubic);
            for (uint i = node.first; w > 0.0 && i < node.first + lobes_of_leaf(node.mask); ++i) {
                float facing = max(dot(normal, lobe_normal(i)), 0.0);
                facing *= facing;
                float weight = w * facing * facing;
                sum += weight * indirect_field[i].rgb;
                weights += weight;
            }
            continue;
        }
        int shift = depth - level - 1;
        uint child = node.first;
        for (uint octant = 0u; octant < 8u; ++octant) {
            if (((node.mask >> octant) & 1u) == 0u) continue;
            ivec3 c = cell * 2 + ivec3(octant & 1u, (octant >> 1) & 1u, octant >> 2);
            ivec3 c_low = c << shift;
            ivec3 c_high = c_low + ((1 << shift) - 1);
            if (all(lessThanEqual(c_low, high)) && all(greaterThanEqual(c_high, low)) &&
                top < kLookupStack) {
                stack_node[top] = child;
                stack_cell[top] = uvec2(uint(c.x) | uint(c.y) << 16,
                                        uint(c.z) | uint(level + 1) << 16);
                ++top;
            }
            ++child;
        }
    }
    return weights > 0.0 ? sum / weights : vec3(0.0);
}
#endif

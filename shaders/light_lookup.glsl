#ifndef LIGHT_LOOKUP_GLSL
#define LIGHT_LOOKUP_GLSL
// Light between the lobes: sums over the leaves round a point, divided by the weights of those that
// are there, so that empty cells neither darken nor brighten. Lobes count by (n . n_lobe)^8 and less
// off the point's tangent plane, those facing away not at all: the two sides of a thin wall stay
// apart. What a lobe has is turned to the point's normal first: rock's irradiance changes more with
// the normal than with the place.
#include "octree.glsl"
#include "wall.glsl"

#ifndef __cplusplus
layout(std430, binding = BINDING_LIGHT) readonly buffer LobeLights { LobeLight lobe_lights[]; };
#endif

#ifndef EACH_LOBE
#define EACH_LOBE(lobe, likeness)   // what a pass makes of a lobe near a point, as like it as 0..1
#endif

CONSTANT int kLookupStack = 96;   // 7 siblings wait on each level at most, 14 levels

// Weight of a leaf whose centre lies `d` leaf edges away along one axis: a cubic B-spline or a hat.
ANY_FLOAT lookup_weight(ANY_FLOAT d, bool tricubic) {
    ANY_FLOAT near = max(1.0f - abs(d), 0.0f);
    ANY_FLOAT far = max(2.0f - abs(d), 0.0f);
    return tricubic ? (far * far * far - 4.0f * near * near * near) * (1.0f / 6.0f) : near;
}

ANY_FLOAT facing_weight(ANY_FLOAT cosine) {
    ANY_FLOAT c = max(cosine, 0.0f);
    c *= c;
    c *= c;
    return c * c;
}

// `height` over the point's tangent plane, m.
ANY_FLOAT plane_weight(ANY_FLOAT height) {
    ANY_FLOAT h = height * (1.0f / grid.voxel_size);
    return exp(-4.0f * min(h * h, 16.0f));
}

CONSTANT float kThroughWall = 1e-5f;   // of the weight that a lobe in another room would have

// Whether `wall` (1 + a lobe, 0 for none), which rises beside the surface point `here`, stands between
// it and `there`.
bool wall_between(uint wall, vec3 here, vec3 there) {
    return wall != 0u && stands_between(lobe_normal(wall - 1u), lobe_position(wall - 1u),
                                        grid.voxel_size, here, there);
}

// The wall beside lobe i (viewer/light/walls.h).
uint wall_beside(uint i) { return uint(lobe_lights[i].irradiance.w); }

// Irradiance of what faces along `from` if it faced along `normal`. Its hemisphere loses the share
// (1 - cosine) / 2 to the rock round it and sees that instead; the rest follows the gradient.
ANY_VEC3 turned_irradiance(LobeLight light, vec3 from, ANY_VEC3 normal) {
    ANY_FLOAT cosine = dot(normal, from);
    ANY_VEC3 tilt = normal - cosine * from;
    ANY_VEC3 sum = 0.5f * (1.0f + cosine) * vec3(light.irradiance);
    for (int c = 0; c < 3; ++c) {
        vec4 turn = light.turn[c];
        sum[c] += dot(tilt, vec3(turn)) + 0.5f * (1.0f - cosine) * turn.w;
    }
    return max(sum, vec3(0.0f));
}

#ifndef LIGHT_AROUND   // by which a pass that looks up much may bring a quicker one
#define LIGHT_AROUND light_around

// Reflected light at a surface point from the leaves whose centres lie within 2 * width leaf edges
// along every axis (1 without `tricubic`). The w of `irradiance` is the sum of weights: zero where
// there is no surface near. Lobes beyond `wall`, which rises beside the point, or beyond whose own wall
// the point lies, count only where there are no others.
LobeLight light_around(vec3 position, vec3 normal, float width, bool tricubic, uint wall) {
    bool turning = (grid.flags & LIGHT_FLAG_FAITHFUL) == 0u;
    int depth = int(grid.depth);
    vec3 at = (position - cube_min()) / grid.voxel_size - 0.5f;   // leaf centres at whole numbers
    at = clamp(at, vec3(-8.0f), vec3(float(1 << depth) + 8.0f));   // outside is outside, and an int
    float reach = (tricubic ? 2.0f : 1.0f) * width;
    ivec3 low = ivec3(ceil(at - reach));
    ivec3 high = ivec3(floor(at + reach));

    uint stack_node[kLookupStack];
    uvec2 stack_cell[kLookupStack];   // x: 16 bits x, 16 bits y; y: 16 bits z, 16 bits level
    int top = 1;
    stack_node[0] = 0u;
    stack_cell[0] = uvec2(0u);
    LobeLight light;
    light.irradiance = vec4(0.0f);
    for (int c = 0; c < 3; ++c) light.turn[c] = vec4(0.0f);
    while (top > 0) {
        --top;
        Node node = nodes[stack_node[top]];
        uvec2 place = stack_cell[top];
        ivec3 cell = ivec3(place.x & 0xffffu, place.x >> 16, place.y & 0xffffu);
        int level = int(place.y >> 16);
        if (level == depth) {
            vec3 d = (vec3(cell) - at) / width;
            float w = lookup_weight(d.x, tricubic) * lookup_weight(d.y, tricubic) *
                      lookup_weight(d.z, tricubic);
            for (uint i = node.first; w > 0.0f && i < node.first + lobes_of_leaf(node.mask); ++i) {
                vec3 facing = lobe_normal(i);
                float likeness = facing_weight(dot(normal, facing)) *
                                 plane_weight(dot(normal, lobe_position(i) - position));
                float weight = w * likeness;
                if (weight <= 0.0f) continue;
                EACH_LOBE(i, likeness);
                if (turning && (wall_between(wall, position, lobe_position(i)) ||
                                wall_between(wall_beside(i), lobe_position(i), position))) {
                    weight *= kThroughWall;
                }
                vec3 irradiance = turning ? turned_irradiance(lobe_lights[i], facing, normal)
                                          : vec3(lobe_lights[i].irradiance);
                light.irradiance += weight * vec4(irradiance, 1.0f);
                for (int c = 0; c < 3; ++c) light.turn[c] += weight * lobe_lights[i].turn[c];
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
    float weights = light.irradiance.w;
    if (weights > 0.0f) {
        light.irradiance = vec4(vec3(light.irradiance) / weights, weights);
        for (int c = 0; c < 3; ++c) light.turn[c] /= weights;
    }
    return light;
}
#endif

// rgb: irradiance that was reflected at least once, W/m2, at a surface point; a: 0 where there is no
// surface near that faces its way, else positive.
vec4 indirect_light(vec3 position, vec3 normal) {
    bool tricubic = (grid.flags & LIGHT_FLAG_TRICUBIC) != 0u;
    return LIGHT_AROUND(position, normal, 1.0f, tricubic, 0u).irradiance;
}

vec3 indirect_irradiance(vec3 position, vec3 normal) {
    return vec3(indirect_light(position, normal));
}
#endif

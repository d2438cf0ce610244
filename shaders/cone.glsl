#ifndef CONE_GLSL
#define CONE_GLSL
// Cones through the filtered octree (Crassin et al. 2011; the paper's gather), with the corrections
// of light.md, 3.2: optical depth is interpolated, not opacity; what lies below the receiver's
// tangent plane is left out; a cone that ends in rock is divided by what it saw.
#include "sides.glsl"

struct Cone {
    vec3 origin;
    vec3 direction;     // unit
    vec3 plane_normal;  // the receiver's
    float spread;       // diameter of the footprint per length
    float start;        // m
};

// What a ray along `direction` sees of a node: the three sides that face it. rgb: radiance times
// optical depth across the node, a: optical depth (faithful: premultiplied radiance and opacity).
vec4 node_along(uint node, vec3 direction, bool faithful) {
    vec3 weights = abs(direction);
    if (faithful) weights /= weights.x + weights.y + weights.z;
    vec4 sum = vec4(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
        uint side = uint(2 * axis) + (direction[axis] > 0.0f ? 1u : 0u);
        vec4 seen = unpack_side(sides[6u * node + side]);
        if (!faithful) {
            float depth = -log(max(1.0f - seen.w, 1e-3f));
            seen = vec4(seen.w > 0.0f ? vec3(seen) * (depth / seen.w) : vec3(0.0f), depth);
        }
        sum += weights[axis] * seen;
    }
    return sum;
}

// Trilinear sample of a level.
vec4 sample_level(Cone cone, vec3 point, int level, bool faithful) {
    float edge = grid.voxel_size * float(1 << (int(grid.depth) - level));
    vec3 at = (point - cube_min()) / edge - 0.5f;
    ivec3 low = ivec3(floor(at));
    vec3 f = at - vec3(low);
    vec3 along = abs(cone.plane_normal);
    float least_height = 0.5f * edge * (along.x + along.y + along.z);
    vec4 sum = vec4(0.0f);
    float weights = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        ivec3 step = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
        vec3 w = mix(1.0f - f, f, vec3(step));
        float weight = w.x * w.y * w.z;
        if (weight <= 0.0f) continue;
        if (!faithful) {
            vec3 centre = cube_min() + (vec3(low + step) + 0.5f) * edge;
            if (dot(centre - cone.origin, cone.plane_normal) < least_height) continue;
        }
        weights += weight;
        uint node = node_at(low + step, level);
        if (node != NO_HIT) sum += weight * node_along(node, cone.direction, faithful);
    }
    return weights > 0.0f ? sum / weights : vec4(0.0f);
}

// Two trilinear samples from the levels next to the footprint's.
vec4 sample_footprint(Cone cone, vec3 point, float diameter, bool faithful) {
    float coarser = clamp(log2(max(diameter / grid.voxel_size, 1.0f)), 0.0f, float(grid.depth));
    int fine = int(grid.depth) - int(floor(coarser));
    int coarse = max(fine - 1, 0);
    float blend = fract(coarser);
    vec4 a = sample_level(cone, point, fine, faithful);
    vec4 b = blend > 0.0f ? sample_level(cone, point, coarse, faithful) : a;
    if (!faithful) {   // optical depth per length, as the levels differ in theirs
        a /= grid.voxel_size * exp2(floor(coarser));
        b /= grid.voxel_size * exp2(float(int(grid.depth) - coarse));
    }
    return mix(a, b, blend);
}

// Radiance that arrives along a cone.
vec3 trace_cone(Cone cone, bool faithful) {
    vec3 radiance = vec3(0.0f);
    float clear = 1.0f;
    float t = cone.start;
    while (clear > 0.01f && t < 1.8f * grid.cube_edge) {
        float diameter = max(cone.spread * t, grid.voxel_size);
        vec3 point = cone.origin + cone.direction * t;
        vec4 seen = sample_footprint(cone, point, diameter, faithful);
        if (seen.w > 0.0f) {
            if (faithful) {   // a step is as long as the footprint is wide: opacity needs no correction
                radiance += clear * vec3(seen);
                clear *= 1.0f - min(seen.w, 1.0f);
            } else {
                float opacity = 1.0f - exp(-seen.w * diameter);
                radiance += clear * opacity * vec3(seen) / seen.w;
                clear *= 1.0f - opacity;
            }
        }
        t += diameter;
    }
    float met = 1.0f - clear;
    return !faithful && met > 0.5f ? radiance / met : radiance;
}
#endif

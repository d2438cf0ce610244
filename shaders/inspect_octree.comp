#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "tone_curve.glsl"
#include "cone.glsl"

// One level of the octree as cones see it: what the cell has that a pixel's surface lies in. `layer`
// counts as Layer of viewer/frame/inspector.h.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) readonly buffer pixel_surfaces { vec4 surfaces[]; };
layout(binding = 0, rgba8) uniform writeonly image2D picture;
layout(location = 0) uniform float exposure;   // stops
layout(location = 1) uniform uint curve;
layout(location = 2) uniform uint layer;
layout(location = 3) uniform int level;

const uint kVoxels = 8u, kOpacity = 9u;
const float kInside = 0.02;   // leaf edges: the drawn surface lies a little in front of its leaf

// A colour that differs from its neighbours'.
vec3 cell_colour(ivec3 cell) {
    uvec3 c = uvec3(cell);
    uint h = (c.x * 73856093u) ^ (c.y * 19349663u) ^ (c.z * 83492791u);
    h = (h ^ (h >> 15)) * 2246822519u;
    return 0.25 + 0.75 * vec3(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u) / 255.0;
}

vec3 layer_at(uvec2 place, vec4 surface) {
    vec3 origin, ray;
    camera_ray(vec2(place) + 0.5, origin, ray);
    vec3 along = octree_from_camera_direction(ray);
    vec3 point = octree_from_camera(origin) + along * surface.w -
                 surface.xyz * kInside * grid.voxel_size;
    float edge = grid.voxel_size * float(1 << (int(grid.depth) - level));
    ivec3 cell = ivec3(floor((point - cube_min()) / edge));
    uint node = node_at(cell, level);
    if (node == NO_HIT) return vec3(0.0);
    if (layer == kVoxels) return cell_colour(cell);
    vec4 seen = node_along(node, normalize(along), true);
    if (layer == kOpacity) return vec3(min(seen.a, 1.0));
    vec3 radiance = seen.a > 0.0 ? seen.rgb / seen.a : vec3(0.0);
    return srgb_encoded(tone_curve(curve, radiance * exp2(exposure)));
}

void main() {
    ivec2 size = imageSize(picture), place = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(place, size))) return;
    vec4 surface = surfaces[place.y * size.x + place.x];
    vec3 colour = surface.w > 0.0 ? layer_at(uvec2(place), surface) : vec3(0.0);
    imageStore(picture, place, vec4(colour, 1.0));
}

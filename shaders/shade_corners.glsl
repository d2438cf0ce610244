#ifndef SHADE_CORNERS_GLSL
#define SHADE_CORNERS_GLSL
// Reflected light for a pixel from the corners of its square of SHADE_TILE x SHADE_TILE pixels, where
// they lie near it on its surface; else looked up for it alone. The pass has corners.
#include "shade_pixel.glsl"

#include "light_lookup.glsl"

CONSTANT float kFarCorner = 0.25f;   // leaf edges: farther, a corner says nothing about a pixel
CONSTANT float kLeastShare = 0.3f;   // of the corners, by likeness, that have to be on its surface

uvec2 corners_of_view() { return uvec2(view.width, view.height) / uint(SHADE_TILE) + 2u; }

CornerLight light_of_corner(uvec2 corner) {
    Pixel pixel =
        pixel_at(min(corner * uint(SHADE_TILE), uvec2(view.width - 1u, view.height - 1u)));
    CornerLight found;
    found.surface = pixel.surface;
    found.position = vec4(pixel.position, 0.0f);
    found.light.irradiance = vec4(0.0f);
    if (pixel.surface.w > 0.0f) {
        bool tricubic = (grid.flags & LIGHT_FLAG_TRICUBIC) != 0u;
        found.light = light_around(pixel.position, vec3(pixel.surface), 1.0f, tricubic, 0u);
    }
    return found;
}

vec3 irradiance_between_corners(Pixel pixel, uvec2 at) {
    vec3 normal = vec3(pixel.surface);
    vec2 place = vec2(at.x % uint(SHADE_TILE), at.y % uint(SHADE_TILE)) / float(SHADE_TILE);
    bool turning = (grid.flags & LIGHT_FLAG_FAITHFUL) == 0u;
    vec3 sum = vec3(0.0f);
    float shares = 0.0f;
    for (uint i = 0u; i < 4u; ++i) {
        uvec2 corner = at / uint(SHADE_TILE) + uvec2(i & 1u, i >> 1);
        uint index = corner.y * corners_of_view().x + corner.x;
        vec3 apart = vec3(corners[index].position) - pixel.position;
        vec3 facing = vec3(corners[index].surface);
        if (corners[index].surface.w <= 0.0f || corners[index].light.irradiance.w <= 0.0f ||
            dot(apart, apart) > kFarCorner * kFarCorner * grid.voxel_size * grid.voxel_size) {
            continue;
        }
        float share = ((i & 1u) != 0u ? place.x : 1.0f - place.x) *
                      ((i >> 1) != 0u ? place.y : 1.0f - place.y) *
                      facing_weight(dot(normal, facing)) * plane_weight(dot(normal, apart));
        if (share <= 0.0f) continue;
        sum += share * (turning ? turned_irradiance(corners[index].light, facing, normal)
                                : vec3(corners[index].light.irradiance));
        shares += share;
    }
    return shares >= kLeastShare ? sum / shares : indirect_irradiance(pixel.position, normal);
}
#endif

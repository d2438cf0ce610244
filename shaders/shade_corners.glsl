#ifndef SHADE_CORNERS_GLSL
#define SHADE_CORNERS_GLSL
// Reflected light and lamps for a pixel from the corners of its square of SHADE_TILE x SHADE_TILE
// pixels, where they lie near it on its surface; else light is looked up for it alone, and lamps are
// not known. The pass has corners.
#include "shade_pixel.glsl"
#include "light_lookup.glsl"

// Leaf edges: farther, a corner says nothing about a pixel's reflected light, or about its lamps,
// which the lobes have seen that lie as far round the corner and farther.
CONSTANT float kFarCorner = 0.25f, kFarFromLamps = 1.5f;
CONSTANT float kLeastShare = 0.3f;   // of the corners, by likeness, that have to be on its surface

uvec2 corners_of_view() { return uvec2(view.width, view.height) / uint(SHADE_TILE) + 2u; }

// How much the pixel makes of its square's i-th corner, whose `index` it gets too: 0..1.
float share_of_corner(Pixel pixel, uvec2 at, uint i, float far, OUT(uint) index) {
    vec2 place = vec2(at.x % uint(SHADE_TILE), at.y % uint(SHADE_TILE)) / float(SHADE_TILE);
    uvec2 corner = at / uint(SHADE_TILE) + uvec2(i & 1u, i >> 1);
    index = corner.y * corners_of_view().x + corner.x;
    vec3 normal = vec3(pixel.surface);
    vec3 apart = vec3(corners[index].position) - pixel.position;
    if (corners[index].surface.w <= 0.0f || corners[index].light.irradiance.w <= 0.0f ||
        dot(apart, apart) > far * far * grid.voxel_size * grid.voxel_size) {
        return 0.0f;
    }
    return ((i & 1u) != 0u ? place.x : 1.0f - place.x) *
           ((i >> 1) != 0u ? place.y : 1.0f - place.y) *
           facing_weight(dot(normal, vec3(corners[index].surface))) *
           plane_weight(dot(normal, apart));
}

vec3 irradiance_between_corners(Pixel pixel, uvec2 at) {
    vec3 normal = vec3(pixel.surface);
    bool turning = (grid.flags & LIGHT_FLAG_FAITHFUL) == 0u;
    vec3 sum = vec3(0.0f);
    float shares = 0.0f;
    for (uint i = 0u; i < 4u; ++i) {
        uint index;
        float share = share_of_corner(pixel, at, i, kFarCorner, index);
        if (share <= 0.0f) continue;
        sum += share * (turning ? turned_irradiance(corners[index].light,
                                                    vec3(corners[index].surface), normal)
                                : vec3(corners[index].light.irradiance));
        shares += share;
    }
    return shares >= kLeastShare ? sum / shares : indirect_irradiance(pixel.position, normal);
}

// x: bits of the lamps of the corners' group that all of the pixel's corners see, y: that none sees.
uvec2 lamps_between_corners(Pixel pixel, uvec2 at) {
    if (pixel.surface.w <= 0.0f) return uvec2(0u);
    uvec2 lamps = uvec2(0xffffffffu);
    float shares = 0.0f;
    for (uint i = 0u; i < 4u; ++i) {
        uint index;
        float share = share_of_corner(pixel, at, i, kFarFromLamps, index);
        if (share <= 0.0f) continue;
        lamps &= uvec2(corners[index].seen, corners[index].hidden);
        shares += share;
    }
    return shares >= kLeastShare ? lamps : uvec2(0u);
}
#endif

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

uint first_corner(uvec2 at) {
    return at.y / uint(SHADE_TILE) * corners_of_view().x + at.x / uint(SHADE_TILE);
}

// How far a pixel, one row's or column's, lies in its square: 0..1.
float place_in_square(uint at) { return float(at % uint(SHADE_TILE)) / float(SHADE_TILE); }

// A surface point at (x, y) in the square whose first corner is `first` learns what its corners know: adds
// the irradiance that is reflected to it to `sum`, weighted by `shares`, and leaves the bits of the
// lamps of the corners' group that all see in `seen` and that none sees in `hidden`.
void ask_corners(ANY_VEC3 position, ANY_VEC3 normal, ANY_FLOAT x, float y, uint first,
                 INOUT(ANY_VEC3) sum, INOUT(ANY_FLOAT) shares, INOUT(ANY_UINT) seen,
                 INOUT(ANY_UINT) hidden, INOUT(ANY_FLOAT) lamp_shares) {
    bool turning = (grid.flags & LIGHT_FLAG_FAITHFUL) == 0u;
    float near = kFarCorner * grid.voxel_size, near_for_lamps = kFarFromLamps * grid.voxel_size;
    for (uint i = 0u; i < 4u; ++i) {
        uint index = first + (i & 1u) + (i >> 1) * corners_of_view().x;
        if (corners[index].surface.w <= 0.0f || corners[index].light.irradiance.w <= 0.0f) continue;
        vec3 facing = vec3(corners[index].surface);
        ANY_VEC3 apart = vec3(corners[index].position) - position;
        ANY_FLOAT share = ((i & 1u) != 0u ? x : 1.0f - x) *
                          (((i >> 1) != 0u ? y : 1.0f - y) * facing_weight(dot(normal, facing))) *
                          plane_weight(dot(normal, apart));
        ANY_FLOAT squared = dot(apart, apart);
        ANY_FLOAT share_of_lamps =
            squared <= near_for_lamps * near_for_lamps ? share : 0.0f * share;
        seen &= share_of_lamps > 0.0f ? corners[index].seen : 0xffffffffu;
        hidden &= share_of_lamps > 0.0f ? corners[index].hidden : 0xffffffffu;
        lamp_shares += share_of_lamps;
        share = squared <= near * near ? share : 0.0f * share;
        if (turning) {
            sum += share * turned_irradiance(corners[index].light, facing, normal);
        } else {
            sum += share * vec3(corners[index].light.irradiance);
        }
        shares += share;
    }
}

// Of a pixel whose corners gave it so much.
vec3 irradiance_of_pixel(Pixel pixel, vec3 sum, float shares) {
    return shares >= kLeastShare ? sum / shares
                                 : indirect_irradiance(pixel.position, vec3(pixel.surface));
}

// x: the lamps that it is known to see, y: that it is known not to see.
uvec2 lamps_of_pixel(uint seen, uint hidden, float lamp_shares) {
    return lamp_shares >= kLeastShare ? uvec2(seen, hidden) : uvec2(0u);
}
#endif

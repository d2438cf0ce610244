#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"

// One light, of an area light some rows of samples, on every pixel's surface: added to what
// shade.comp began with.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) readonly buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_PIXEL_ALBEDOS) readonly buffer pixel_albedos { vec4 albedos[]; };
layout(std430, binding = BINDING_PIXEL_DIRECT) buffer pixel_direct { vec4 direct[]; };
layout(std430, binding = BINDING_PIXEL_SPECULAR) buffer pixel_specular { vec4 specular[]; };
layout(std430, binding = BINDING_PIXEL_EMISSION) readonly buffer pixel_emission { vec4 emission[]; };
layout(std430, binding = BINDING_PIXEL_BEAUTY) buffer pixel_beauty { vec4 beauty[]; };
layout(std430, binding = BINDING_PIXEL_LAMPS) readonly buffer PixelLamps { uvec2 pixel_lamps[]; };
layout(location = 0) uniform uint light;
layout(location = 1) uniform int first_row;
layout(location = 2) uniform int last_row;
layout(location = 3) uniform int sub_pixels;   // along a pixel's edge
layout(location = 4) uniform float wetness;    // 0..1
#include "shade_light.glsl"

const int kLookRow = -1;   // as first_row: look at the light and keep in direct's w what is seen

shared vec4 tile_surface[4];   // that of the tile's first pixel
shared uint tile_seen[4], tile_hidden[4];

void look_together(uvec2 at, bool inside) {
    uvec2 local = gl_LocalInvocationID.xy;
    uint tile = local.y / kTile * 2u + local.x / kTile;
    uint place = local.y % kTile * kTile + local.x % kTile;
    Pixel pixel = pixel_at(inside ? at : uvec2(0));
    bool lit = inside && can_be_lit(pixel);
    if (place == 0u) {
        tile_surface[tile] = lit ? pixel.surface : vec4(0.0);
        tile_seen[tile] = 0u;
        tile_hidden[tile] = 0u;
    }
    memoryBarrierShared();
    barrier();
    if (lit) {
        uint seen, hidden;
        look(pixel, place, tile_surface[tile], seen, hidden);
        atomicAdd(tile_seen[tile], seen);
        atomicAdd(tile_hidden[tile], hidden);
    }
    memoryBarrierShared();
    barrier();
    if (inside) direct[pixel.index].w = how_much_seen(tile_seen[tile], tile_hidden[tile]);
}

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    bool inside = all(lessThan(at, uvec2(view.width, view.height)));
    if (first_row == kLookRow) {
        look_together(at, inside);
    } else if (inside) {
        shade_light(at, first_row, last_row);
    }
}

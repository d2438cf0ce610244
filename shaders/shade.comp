#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"

// What every pixel's surface emits and reflects again; shade_light.comp adds the lights themselves,
// one by one.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_PIXEL_ALBEDOS) buffer pixel_albedos { vec4 albedos[]; };
layout(std430, binding = BINDING_PIXEL_DIRECT) writeonly buffer pixel_direct { vec4 direct[]; };
layout(std430, binding = BINDING_PIXEL_INDIRECT) writeonly buffer pixel_indirect { vec4 indirect[]; };
layout(std430, binding = BINDING_PIXEL_SPECULAR) writeonly buffer pixel_specular { vec4 specular[]; };
layout(std430, binding = BINDING_PIXEL_EMISSION) writeonly buffer pixel_emission { vec4 emission[]; };
layout(std430, binding = BINDING_PIXEL_BEAUTY) writeonly buffer pixel_beauty { vec4 beauty[]; };
layout(std430, binding = BINDING_CORNERS) readonly buffer corner_lights { CornerLight corners[]; };
layout(location = 0) uniform uint panel_count;
layout(location = 1) uniform float wetness;   // 0..1
#include "shade_surface.glsl"

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, uvec2(view.width, view.height)))) return;
    Pixel pixel = pixel_at(at);
    vec3 sum = vec3(0.0), irradiance = vec3(0.0);
    float shares = 0.0, lamp_shares = 0.0;
    uint seen = 0xffffffffu, hidden = 0xffffffffu;
    if (pixel.surface.w > 0.0) {
        ask_corners(pixel.position, vec3(pixel.surface), place_in_square(at.x),
                    place_in_square(at.y), first_corner(at), sum, shares, seen, hidden, lamp_shares);
        irradiance = irradiance_of_pixel(pixel, sum, shares);
    }
    shade_surface(pixel, irradiance);
}

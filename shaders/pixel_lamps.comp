#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"

// Which of a group's lamps every pixel is known to see and not to see.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) readonly buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_CORNERS) readonly buffer corner_lights { CornerLight corners[]; };
layout(std430, binding = BINDING_PIXEL_LAMPS) writeonly buffer PixelLamps { uvec2 pixel_lamps[]; };
#include "shade_corners.glsl"

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, uvec2(view.width, view.height)))) return;
    Pixel pixel = pixel_at(at);
    vec3 sum = vec3(0.0);
    float shares = 0.0, lamp_shares = 0.0;
    uint seen = 0xffffffffu, hidden = 0xffffffffu;
    if (pixel.surface.w > 0.0) {
        ask_corners(pixel.position, vec3(pixel.surface), place_in_square(at.x),
                    place_in_square(at.y), first_corner(at), sum, shares, seen, hidden, lamp_shares);
    }
    pixel_lamps[pixel.index] = lamps_of_pixel(seen, hidden, lamp_shares);
}

#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"

// Reflected light at every SHADE_TILE-th pixel.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) readonly buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_CORNERS) buffer corner_lights { CornerLight corners[]; };
#include "shade_corners.glsl"

void main() {
    uvec2 corner = gl_GlobalInvocationID.xy;
    uvec2 count = corners_of_view();
    if (all(lessThan(corner, count))) corners[corner.y * count.x + corner.x] = light_of_corner(corner);
}

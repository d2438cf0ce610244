#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"

// Reflected light and a group's lamps at every SHADE_TILE-th pixel.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) readonly buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_CORNERS) buffer corner_lights { CornerLight corners[]; };
layout(std430, binding = BINDING_LAMP_LOOKS) readonly buffer LampLooks { uvec2 lamp_looks[]; };
layout(location = 0) uniform uint lamp_group;
layout(location = 1) uniform uint looks_kept;   // 0: lobes have not looked
uvec2 looks_of(uint lobe);
#include "corner_light.glsl"

uvec2 looks_of(uint lobe) {
    return looks_kept != 0u ? lamp_looks[lamp_group * grid.lobe_count + lobe] : uvec2(0u);
}

void main() {
    uvec2 corner = gl_GlobalInvocationID.xy;
    uvec2 count = corners_of_view();
    if (all(lessThan(corner, count))) corners[corner.y * count.x + corner.x] = light_of_corner(corner);
}

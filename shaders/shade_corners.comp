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
void note_lobe(uint lobe);
#include "corner_light.glsl"

uint lamps_seen = 0u, lamps_hidden = 0u;   // by all lobes round a corner

void note_lobe(uint lobe) {
    uvec2 looks =
        looks_kept != 0u ? lamp_looks[lamp_group * grid.lobe_count + lobe] : uvec2(0u);
    agree_with(looks, lamps_seen, lamps_hidden);
}

void main() {
    uvec2 corner = gl_GlobalInvocationID.xy;
    uvec2 count = corners_of_view();
    if (any(greaterThanEqual(corner, count))) return;
    lamps_seen = lamps_hidden = 0xffffffffu;
    CornerLight found = light_of_corner(corner);
    set_lamps(found, lamps_seen, lamps_hidden);
    corners[corner.y * count.x + corner.x] = found;
}

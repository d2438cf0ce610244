// What is looked up at a corner of a square of pixels (shade_corners.glsl): reflected light, and which
// of a group's lamps the lobes round it see. The pass has lamp_group, corners, and note_lobe(lobe),
// which is told of these lobes.
#define EACH_LOBE(lobe, likeness) \
    if (noting_lobes && (likeness) > kAlike) note_lobe(lobe)
CONSTANT float kAlike = 0.02f;   // lobes that are less like a point say nothing about its lamps
bool noting_lobes = false;
#include "shade_corners.glsl"

// A corner that the first group of lamps has begun with, for another group: what pixels show may have
// changed since, where a panel is in front of it.
CornerLight light_of_corner(uvec2 corner) {
    CornerLight found = corners[corner.y * corners_of_view().x + corner.x];
    if (lamp_group == 0u) {
        Pixel pixel =
            pixel_at(min(corner * uint(SHADE_TILE), uvec2(view.width - 1u, view.height - 1u)));
        found.surface = pixel.surface;
        found.position = vec4(pixel.position, 0.0f);
        found.light.irradiance = vec4(0.0f);
    }
    if (found.surface.w > 0.0f) {
        bool tricubic = (grid.flags & LIGHT_FLAG_TRICUBIC) != 0u;
        noting_lobes = true;
        found.light = LIGHT_AROUND(vec3(found.position), vec3(found.surface), 1.0f, tricubic, 0u);
        noting_lobes = false;
    }
    return found;
}

// The corner's lamps, from the bits of those that all lobes noted for it see and that none of them
// sees; all bits in both where there are no such lobes.
void set_lamps(INOUT(CornerLight) corner, uint seen, uint hidden) {
    uint no_lobe = seen & hidden;   // said anything
    corner.seen = seen & ~no_lobe;
    corner.hidden = hidden & ~no_lobe;
}

// What is left of the lamps `seen` and `hidden` by some lobes, with one more that looked (lamp_looks.glsl).
void agree_with(uvec2 looks, INOUT(uint) seen, INOUT(uint) hidden) {
    seen &= looks.x & ~looks.y;
    hidden &= looks.y & ~looks.x;
}

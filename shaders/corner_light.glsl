// What is looked up at a corner of a square of pixels (shade_corners.glsl): reflected light, and which
// of a group's lamps the lobes round it see. The pass has lamp_group, corners, and looks_of(lobe): the
// bits of the group's lamps that a lobe sees and does not see (lamp_looks.glsl), both where that is
// not known.
#define EACH_LOBE(lobe, likeness) \
    if (noting_lamps && (likeness) > kAlike) note_lamps(lobe)
CONSTANT float kAlike = 0.02f;   // lobes that are less like a point say nothing about its lamps
bool noting_lamps = false;
uint lamps_seen = 0u, lamps_hidden = 0u;   // by all lobes round a point
void note_lamps(uint lobe) {
    uvec2 looks = looks_of(lobe);
    lamps_seen &= looks.x & ~looks.y;
    lamps_hidden &= looks.y & ~looks.x;
}
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
    lamps_seen = lamps_hidden = 0xffffffffu;
    if (found.surface.w > 0.0f) {
        bool tricubic = (grid.flags & LIGHT_FLAG_TRICUBIC) != 0u;
        noting_lamps = true;
        found.light =
            light_around(vec3(found.position), vec3(found.surface), 1.0f, tricubic, 0u);
        noting_lamps = false;
    }
    uint no_lobe = lamps_seen & lamps_hidden;   // said anything
    found.seen = lamps_seen & ~no_lobe;
    found.hidden = lamps_hidden & ~no_lobe;
    return found;
}

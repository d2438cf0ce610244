#ifndef LAMP_LOOKS_GLSL
#define LAMP_LOOKS_GLSL
// Which lamps a lobe sees, kept while lamps rest, for LAMPS_IN_GROUP of them at once. Pixels among
// lobes that agree about a lamp need no shadow rays: what shadows a wall is as large as a leaf or
// larger, and its shadow larger still.
#include "direct_light.glsl"

// Along an area light's edges: as many places a lobe looks at.
CONSTANT int kLooksAlong = 6;

// x: the lamp's bit in its group where the lobe sees all of it, y: where it sees nothing; both where
// it sees a part, or faces away from it while what lies round it may not.
uvec2 look_at_lamp(uint lobe, uint lamp) {
    uint bit = lamp_bit(lamp);
    Light at = lights[lamp];
    bool area = at.kind == LIGHT_AREA;
    vec3 position = lobe_position(lobe), normal = lobe_normal(lobe);
    vec3 lamp_normal = area ? vec3(at.axis) : vec3(0.0f);
    int looks = area ? kLooksAlong * kLooksAlong : 1;
    uvec2 seen = uvec2(0u);
    for (int i = 0; i < looks && (seen.x == 0u || seen.y == 0u); ++i) {
        vec2 place = area ? (vec2(i % kLooksAlong, i / kLooksAlong) + 0.5f) / float(kLooksAlong)
                          : vec2(0.0f);
        vec3 point = vec3(at.position) + place.x * vec3(at.edge_u) + place.y * vec3(at.edge_v);
        vec3 to_lamp = point - position;
        if (dot(normal, to_lamp) <= 0.0f || (area && dot(lamp_normal, to_lamp) >= 0.0f)) {
            return uvec2(bit);
        }
        if (visible_from(position, normal, kPointOffset * grid.voxel_size, point, at.tag,
                         lamp_normal)) {
            seen.x = bit;
        } else {
            seen.y = bit;
        }
    }
    return seen;
}
#endif

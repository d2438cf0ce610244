#ifndef RADIATE_GLSL
#define RADIATE_GLSL
#include "octree.glsl"

CONSTANT float kInversePi = 0.31830988618f;

// Outgoing radiance of a lobe: what it emits and what it reflects of the irradiance it gets
// (L = Le + albedo/pi (E_direct + E_indirect), re-evaluated, never added up).
vec3 lobe_radiance(uint i, vec3 emitted, vec3 arriving) {
    bool faithful = (grid.flags & LIGHT_FLAG_FAITHFUL) != 0u;
    vec3 reflected = faithful ? clamp(lobe_albedo(i), vec3(0.0f), vec3(kMaxAlbedo))
                              : lobe_reflectance(i);
    return emitted + reflected * kInversePi * arriving;
}
#endif

#ifndef SMOOTHING_GLSL
#define SMOOTHING_GLSL
// A lobe's rays are few and its neighbours have others: their noise is spread over the surface
// within two leaves, each lobe's light turned to the normal it is carried to.
#include "light_lookup.glsl"

CONSTANT float kSmoothing = 2.0f;   // width of the kernel, in those of the lookup's

LobeLight smoothed_light(uint i) {
    LobeLight own = lobe_lights[i];
    LobeLight light = light_around(lobe_position(i), lobe_normal(i), kSmoothing, true, wall_beside(i));
    if (light.irradiance.w <= 0.0f) return own;
    light.irradiance.w = own.irradiance.w;
    for (int c = 0; c < 3; ++c) light.turn[c].w = own.turn[c].w;
    return light;
}
#endif

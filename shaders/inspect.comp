#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "tone_curve.glsl"

// One layer of a frame as a picture. `layer` counts as Layer of viewer/frame/inspector.h.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) readonly buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_PIXEL_ALBEDOS) readonly buffer pixel_albedos { vec4 albedos[]; };
layout(std430, binding = BINDING_PIXEL_DIRECT) readonly buffer pixel_direct { vec4 direct[]; };
layout(std430, binding = BINDING_PIXEL_INDIRECT) readonly buffer pixel_indirect { vec4 indirect[]; };
layout(binding = 0, rgba8) uniform writeonly image2D picture;
layout(location = 0) uniform float exposure;   // stops
layout(location = 1) uniform uint curve;
layout(location = 2) uniform uint layer;

const float kLeastFacing = 0.15;

vec3 exposed(vec3 radiance) { return tone_curve(curve, radiance * exp2(exposure)); }

// As a lamp at the eye would show it that shines alike at any distance.
vec3 unlit(ivec2 place, int pixel) {
    vec3 origin, ray;
    camera_ray(vec2(place) + 0.5, origin, ray);
    float facing = abs(dot(normalize(octree_from_camera_direction(ray)), surfaces[pixel].xyz));
    return albedos[pixel].rgb * mix(kLeastFacing, 1.0, facing);
}

vec3 layer_at(ivec2 place, int pixel) {
    vec4 surface = surfaces[pixel];
    if (layer == 1u) return srgb_encoded(exposed(direct[pixel].rgb));
    if (layer == 2u) return srgb_encoded(exposed(indirect[pixel].rgb));
    if (surface.w <= 0.0) return vec3(0.0);
    if (layer == 3u) return srgb_encoded(albedos[pixel].rgb);
    if (layer == 4u) return surface.xyz * 0.5 + 0.5;
    if (layer == 5u) return vec3(albedos[pixel].w);
    if (layer == 6u) return vec3(fract(surface.w));   // a ramp a metre
    return srgb_encoded(unlit(place, pixel));
}

void main() {
    ivec2 size = imageSize(picture), place = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(place, size))) return;
    imageStore(picture, place, vec4(layer_at(place, place.y * size.x + place.x), 1.0));
}

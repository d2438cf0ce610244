#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "tone_curve.glsl"

// Exposure, tone curve and sRGB: radiance becomes a picture.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_BEAUTY) readonly buffer pixel_beauty { vec4 beauty[]; };
layout(binding = 0, rgba8) uniform writeonly image2D picture;
layout(location = 0) uniform float exposure;   // stops
layout(location = 1) uniform uint curve;

void main() {
    ivec2 size = imageSize(picture), place = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(place, size))) return;
    vec3 radiance = beauty[place.y * size.x + place.x].rgb;
    imageStore(picture, place,
               vec4(srgb_encoded(tone_curve(curve, radiance * exp2(exposure))), 1.0));
}

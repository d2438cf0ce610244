#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surface_sums.glsl"
#include "pixel_sums.glsl"

// The sums become a surface per pixel, and the buffers are left clean for the next frame.
layout(local_size_x = 128) in;
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };
layout(std430, binding = BINDING_PIXEL_SURFACES) writeonly buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_PIXEL_ALBEDOS) writeonly buffer pixel_albedos { vec4 albedos[]; };

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint pixel = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (pixel >= view.width * view.height) return;

    surfaces[pixel] =
        mean_surface(normal_sums[pixel], behind_sums[pixel], uintBitsToFloat(depths[pixel]));
    albedos[pixel] = mean_albedo(normal_sums[pixel], albedo_sums[pixel]);

    depths[pixel] = kFarthest;
    clear_surface(pixel);
}

#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surface_sums.glsl"

// The sums become a surface per pixel, and the buffers are left clean for the next frame.
layout(local_size_x = 128) in;
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };
// Normal in the octree's frame, w: depth, 0 where nothing was hit; albedo, w: NDF length, that of
// the mean of the discs' NDF vectors.
layout(std430, binding = BINDING_PIXEL_SURFACES) writeonly buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_PIXEL_ALBEDOS) writeonly buffer pixel_albedos { vec4 albedos[]; };

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint pixel = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (pixel >= view.width * view.height) return;

    vec4 surface = vec4(0.0), albedo = vec4(0.0);
    float weight = float(normal_sums[pixel].w);
    if (weight > 0.0) {
        vec3 normal = octree_from_camera_direction(vec3(normal_sums[pixel].xyz));
        float depth = uintBitsToFloat(depths[pixel]) + float(behind_sums[pixel]) / weight;
        float total = length(normal);
        surface = vec4(normal / max(total, 1e-20), depth);
        albedo = vec4(albedo_sums[pixel]) / weight;
        albedo.w *= min(total / weight, 1.0);
    }
    surfaces[pixel] = surface;
    albedos[pixel] = albedo;

    depths[pixel] = kFarthest;
    clear_surface(pixel);
}

#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surface_sums.glsl"

// The sums become a surface per pixel, and the buffers are left clean for the next frame.
layout(local_size_x = 128) in;
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };
layout(binding = 0, rgba32f) uniform writeonly image2D surface_image;   // normal; w: depth, 0: none
layout(binding = 1, rgba32f) uniform writeonly image2D albedo_image;    // albedo; w: NDF length

const uint kFarthest = 0x7f800000u;   // +infinity

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint pixel = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (pixel >= view.width * view.height) return;

    vec4 surface = vec4(0.0), albedo = vec4(0.0);
    float weight = float(normal_sums[pixel].w);
    if (weight > 0.0) {
        vec3 normal = octree_from_camera_direction(vec3(normal_sums[pixel].xyz));
        float depth = uintBitsToFloat(depths[pixel]) + float(behind_sums[pixel]) / weight;
        surface = vec4(normal / max(length(normal), 1e-20), depth);
        albedo = vec4(albedo_sums[pixel]) / weight;
    }
    ivec2 place = ivec2(pixel % view.width, pixel / view.width);
    imageStore(surface_image, place, surface);
    imageStore(albedo_image, place, albedo);

    depths[pixel] = kFarthest;
    normal_sums[pixel] = ivec4(0);
    albedo_sums[pixel] = uvec4(0u);
    behind_sums[pixel] = 0;
}

#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surface_sums.glsl"
#include "rims.glsl"

// A rim gives way to what lies behind it, or to nothing where it borders on nothing. Else it stays,
// better than a hole: what is blended next finds its discs again.
layout(local_size_x = 128) in;
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };
layout(std430, binding = BINDING_RIMS) readonly buffer pixel_rims { float rims[]; };

const int kMostSteps = 16;   // pixels that rims are wide at most

bool borders_on_nothing(ivec2 from) {
    for (int i = 0; i < 9; ++i) {
        ivec2 direction = ivec2(i % 3, i / 3) - 1;
        if (direction == ivec2(0)) continue;
        ivec2 at = from + direction;
        for (int step = 0; step < kMostSteps; ++step, at += direction) {
            if (any(lessThan(at, ivec2(0))) ||
                any(greaterThanEqual(at, ivec2(view.width, view.height)))) {
                break;
            }
            uint pixel = uint(at.y) * view.width + uint(at.x);
            if (rims[pixel] > 0.0) continue;
            if (depths[pixel] == kFarthest) return true;
            break;
        }
    }
    return false;
}

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint pixel = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (pixel >= view.width * view.height || rims[pixel] <= 0.0) return;

    clear_surface(pixel);
    if (depths[pixel] == kFarthest && rims[pixel] != kGap &&
        !borders_on_nothing(ivec2(pixel % view.width, pixel / view.width))) {
        depths[pixel] = floatBitsToUint(rims[pixel]);
    }
}

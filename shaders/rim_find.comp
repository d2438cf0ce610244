#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surface_sums.glsl"
#include "rims.glsl"

// Pixels that only the outer parts of discs reach: the surface's edge is nearer to their centres.
// Random points leave such pixels, and some that nothing reaches, inside a surface as well: with
// that surface on both sides along most lines they are no edge; what was reached stays, and larger
// discs close the rest.
layout(local_size_x = 128) in;
layout(std430, binding = BINDING_DEPTHS) buffer pixel_depths { uint depths[]; };
layout(std430, binding = BINDING_RIMS) writeonly buffer pixel_rims { float rims[]; };

layout(std430, binding = BINDING_RIM_TILES) writeonly buffer rim_tiles { uint tiles[]; };   // 1: holds a rim

// Sum of weights of a rim. Inside a surface of random points it is 1.8 in the mean (splat scale 3).
const float kRimCover = 0.2;
const int kSteps = 10;
const int kStepPixels[kSteps] = int[kSteps](1, 2, 3, 4, 6, 8, 12, 16, 24, 32);
const float kSameDepth = 0.05;   // relative: how far off the line between its sides a surface runs

bool is_solid(uint pixel) { return float(normal_sums[pixel].w) >= kRimCover * kFixedOne; }

// The nearest solid pixel that way: how far it is, 0 where there is none, -1 where the picture ends.
int solid_side(ivec2 from, ivec2 direction, out float inverse_depth) {
    inverse_depth = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        ivec2 at = from + direction * kStepPixels[i];
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(view.width, view.height)))) {
            return -1;
        }
        uint pixel = uint(at.y) * view.width + uint(at.x);
        if (!is_solid(pixel)) continue;
        inverse_depth = 1.0 / uintBitsToFloat(depths[pixel]);
        return kStepPixels[i];
    }
    return 0;
}

// Whether a surface goes on over this pixel. `depth` is what is known of it there, 0 for nothing.
bool is_inside(ivec2 at, float depth) {
    const ivec2 lines[4] = ivec2[4](ivec2(1, 0), ivec2(0, 1), ivec2(1, 1), ivec2(1, -1));
    int inside = 0;
    for (int i = 0; i < 4; ++i) {
        float before, after;
        int steps_before = solid_side(at, -lines[i], before);
        int steps_after = solid_side(at, lines[i], after);
        if (max(steps_before, steps_after) <= 0 || min(steps_before, steps_after) == 0) continue;
        // Planes are straight in the inverse of depth.
        float between = steps_before < 0   ? after
                        : steps_after < 0 ? before
                                          : mix(before, after, float(steps_before) /
                                                                   float(steps_before + steps_after));
        if (depth > 0.0 && abs(depth * between - 1.0) > kSameDepth) continue;
        ++inside;
    }
    return inside >= 3;
}

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint pixel = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (pixel >= view.width * view.height) return;

    float rim = 0.0;
    if (!is_solid(pixel)) {
        bool covered = normal_sums[pixel].w > 0;
        float depth = covered ? uintBitsToFloat(depths[pixel]) : 0.0;
        bool inside = is_inside(ivec2(pixel % view.width, pixel / view.width), depth);
        rim = covered ? (inside ? 0.0 : depth) : (inside ? kGap : 0.0);
    }
    rims[pixel] = rim;
    if (rim > 0.0) {
        depths[pixel] = kFarthest;
        uint columns = (view.width + RIM_TILE - 1u) / RIM_TILE;
        tiles[pixel / view.width / RIM_TILE * columns + pixel % view.width / RIM_TILE] = 1u;
    }
}

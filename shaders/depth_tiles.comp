#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"

// The farthest depth in each square of pixels: what lies behind it there cannot be seen.
layout(local_size_x = 64) in;
layout(std430, binding = BINDING_DEPTHS) readonly buffer pixel_depths { uint depths[]; };
layout(std430, binding = BINDING_DEPTH_TILES) writeonly buffer depth_tiles { uint tiles[]; };

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint tile = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    uint columns = (view.width + DEPTH_TILE - 1u) / DEPTH_TILE;
    uint rows = (view.height + DEPTH_TILE - 1u) / DEPTH_TILE;
    if (tile >= columns * rows) return;

    uvec2 low = uvec2(tile % columns, tile / columns) * DEPTH_TILE;
    uvec2 high = min(low + DEPTH_TILE, uvec2(view.width, view.height));
    uint farthest = 0u;
    for (uint y = low.y; y < high.y; ++y) {
        for (uint x = low.x; x < high.x; ++x) farthest = max(farthest, depths[y * view.width + x]);
    }
    tiles[tile] = farthest;
}

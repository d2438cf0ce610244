// What the frame's passes and C++ both read. The same rules as gpu_layout.h.
#ifdef __cplusplus
#pragma once
#include "shaders/gpu_layout.h"
namespace glowworm::gpu {
#endif

// The camera of viewer/frame/view.h, in the octree's frame.
struct ViewBlock {
    vec4 position;   // xyz: m, relative to the octree's origin; w: focal, pixels
    vec4 right;      // xyz: unit; w: 1 for an orthographic view, else 0
    vec4 down;       // xyz: unit; w: centre x, pixels
    vec4 forward;    // xyz: unit; w: centre y, pixels
    uint width;      // pixels
    uint height;
    uint unused_0;
    uint unused_1;
};

// A chunk that is drawn: the first `count` of its surfels, each grown by `scale`.
struct DrawnChunk {
    vec4 box;      // xyz: lower corner, m, relative to the octree's origin; w: edge, m
    uint first;    // first surfel in the bound page
    uint count;
    float scale;   // disc radius over stored radius
    uint unused_0;
};

// What one workgroup of a splatting pass draws: kSplatGroup surfels of one chunk.
struct SplatBatch {
    uint chunk;   // index into the drawn chunks
    uint first;   // first surfel, counted from the chunk's own
};
#define SPLAT_GROUP 128

#ifdef __cplusplus
}  // namespace glowworm::gpu
#endif

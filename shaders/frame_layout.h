// What the frame's passes and C++ both read. The same rules as gpu_layout.h.
#ifndef FRAME_LAYOUT_H
#define FRAME_LAYOUT_H
#include "gpu_layout.h"
#ifdef __cplusplus
namespace glowworm::gpu {
#endif

// Bindings: storage buffers from BINDING_FRAME_FIRST on, the uniform block after the light's.
#define BINDING_SURFELS (BINDING_FRAME_FIRST + 0)
#define BINDING_DRAWN_CHUNKS (BINDING_FRAME_FIRST + 1)
#define BINDING_SPLAT_BATCHES (BINDING_FRAME_FIRST + 2)
#define BINDING_DEPTHS (BINDING_FRAME_FIRST + 3)
#define BINDING_NORMAL_SUMS (BINDING_FRAME_FIRST + 4)
#define BINDING_ALBEDO_SUMS (BINDING_FRAME_FIRST + 5)
#define BINDING_BEHIND_SUMS (BINDING_FRAME_FIRST + 6)
#define BINDING_PIXEL_SURFACES (BINDING_FRAME_FIRST + 7)
#define BINDING_PIXEL_ALBEDOS (BINDING_FRAME_FIRST + 8)
#define BINDING_PIXEL_DIRECT (BINDING_FRAME_FIRST + 9)
#define BINDING_PIXEL_INDIRECT (BINDING_FRAME_FIRST + 10)
#define BINDING_PIXEL_EMISSION (BINDING_FRAME_FIRST + 11)
#define BINDING_PIXEL_BEAUTY (BINDING_FRAME_FIRST + 12)
#define BINDING_PANELS (BINDING_FRAME_FIRST + 13)
#define BINDING_LUMINANCES (BINDING_FRAME_FIRST + 14)
#define BINDING_RIMS (BINDING_FRAME_FIRST + 15)
#define BINDING_PIXEL_SPECULAR (BINDING_FRAME_FIRST + 16)
#define BINDING_RIM_TILES (BINDING_FRAME_FIRST + 17)
#define BINDING_DEPTH_TILES (BINDING_FRAME_FIRST + 18)
#define BINDING_VIEW 1
// Where what splatting needs is not needed any more:
#define BINDING_CORNERS BINDING_RIMS
#define BINDING_PIXEL_LAMPS BINDING_RIM_TILES

// Pixels along the edge of the squares that say whether a rim lies in them.
#define RIM_TILE 8
// And of those that the depth pyramid (viewer/frame/occlusion.h) begins with.
#define DEPTH_TILE 8
// And of those that know how wide discs are there.
#define WIDTH_TILE 32

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
    vec4 clip_low;   // xyz: m, relative to the octree's origin: only what lies between is drawn
    vec4 clip_high;
};

// A chunk that is drawn. Its first surfels are an even subsample: beyond `full_depth` fewer of them
// are dense enough, and those grow for it (splat.glsl).
struct DrawnChunk {
    vec4 box;           // xyz: lower corner, m, relative to the octree's origin; w: edge, m
    float scale;        // disc radius over stored radius, up to full_depth
    float full_depth;   // m: as far as all are drawn
    uint count;         // surfels drawn there, its first ones
    uint unused_0;
};

// What one workgroup of a splatting pass draws: at most SPLAT_GROUP surfels of one chunk.
struct SplatBatch {
    uint chunk;   // index into the drawn chunks
    uint first;   // first surfel in the bound page
    uint count;
    uint rank;    // the first's place in its chunk
};
#define SPLAT_GROUP 128

// A visible area light: a rectangle, lit on the side its normal points to.
struct Panel {
    vec4 corner;     // xyz: m, relative to the octree's origin
    vec4 edge_u;     // xyz: m
    vec4 edge_v;     // xyz: m
    vec4 radiance;   // rgb: W/sr/m2
};

// Pixels along the edge of the squares at whose corners reflected light and lamps are looked up.
#define SHADE_TILE 4

// What was looked up at the pixel in a corner.
struct CornerLight {
    LobeLight light;   // irradiance's w: the sum of weights, 0 where there is no surface
    vec4 surface;      // the pixel's: unit normal; w: depth, m
    vec4 position;     // xyz: m
    uint seen;         // bits of the lamps of a group that all lobes round it see
    uint hidden;       // and of those that none sees
    uint unused_0;
    uint unused_1;
};

// Every how many pixels exposure looks at one.
#define LUMINANCE_STRIDE 8

#ifdef __cplusplus
}  // namespace glowworm::gpu
#endif
#endif

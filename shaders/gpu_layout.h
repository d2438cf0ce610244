#ifndef GPU_LAYOUT_H
#define GPU_LAYOUT_H
// What C++ and GLSL both read. Only 4-byte scalars and vec4: std430, std140 and C++ then agree on
// every offset (tests/viewer/light_layout_test.cpp holds them to it). Nodes and lobes lie as in the
// file: octree/node_layout.h says what their fields mean.
#ifdef __cplusplus
#define GLM_FORCE_XYZW_ONLY
#include <cstdint>
#include <glm/vec4.hpp>
namespace glowworm::gpu {
using uint = std::uint32_t;
using vec4 = glm::vec4;
#endif

// Where the two spell one thing differently in the topics that are compiled as both
// (viewer/gpu/glsl.h).
#ifdef __cplusplus
#define CONSTANT static constexpr
#define OUT(T) T&
#define INOUT(T) T&
#define ANY_FLOAT auto   // or those of some pixels beside each other (viewer/gpu/lanes.h)
#define ANY_VEC3 auto
#define ANY_UINT auto
#else
#define CONSTANT const
#define OUT(T) out T
#define INOUT(T) inout T
#define ANY_FLOAT float
#define ANY_VEC3 vec3
#define ANY_UINT uint
#endif

// Bindings of storage buffers: the light's are below 12, the frame's start there.
#define BINDING_NODES 0
#define BINDING_LOBES 1
#define BINDING_DIRECT 2     // vec4 per lobe: irradiance straight from lights, W/m2
#define BINDING_INDIRECT 3   // vec4 per lobe: irradiance reflected at least once, W/m2
#define BINDING_RADIANCE 4   // vec4 per lobe: outgoing radiance, W/sr/m2
#define BINDING_LIGHTS 5
#define BINDING_LINKS 6      // while links gather: uint per lobe and ray
#define BINDING_LIGHT 6      // else: LobeLight per lobe
#define BINDING_SIDES 7      // uvec2 per node and side: opacity and radiance for cones
#define BINDING_SCRATCH_A 8
#define BINDING_SCRATCH_B 9
#define BINDING_LAMP_LOOKS 9 // while frames are shaded: uvec2 per group of lamps and lobe
#define BINDING_SCRATCH_C 10
#define BINDING_DENSE 11     // node of every cell of the coarse levels
#define BINDING_FRAME_FIRST 12
// Binding of the uniform block of LightGrid; the frame's start at 1.
#define BINDING_LIGHT_GRID 0

// Levels up to this one have a table of all their cells, the coarser first: level l starts at
// (8^l - 1) / 7.
#define DENSE_LEVELS 6

#define NO_HIT 0xffffffffu
#define BURIED 0xfffffffeu   // octree/trace.h: kBuried

// The octree's grid and how rays meet it.
struct LightGrid {
    float cube_min_x;     // m, relative to the octree's origin
    float cube_min_y;
    float cube_min_z;
    float voxel_size;     // m
    uint depth;           // level of the leaves
    uint lobe_count;
    uint light_count;
    uint flags;           // LIGHT_FLAG_*
    float patch_margin;   // sample spacings
    float reach;          // leaf edges
    float cube_edge;      // m
    uint links_per_lobe;
};

// Reflected light at a lobe, and how it changes as the surface turns (light_lookup.glsl).
struct LobeLight {
    vec4 irradiance;   // rgb: reflected at least once, W/m2, on the lobe's plane; w: 1 + the lobe of
                       // the wall beside it, 0: none (walls.h); whole numbers up to 2^24 are exact
    vec4 turn[3];      // per channel: xyz: what tilting the normal adds per unit, along the plane;
                       // w: the irradiance that the lobe's own surroundings give, pi times radiance
};

#define LIGHT_FLAG_TRICUBIC 1u
#define LIGHT_FLAG_FAITHFUL 2u

// So many lamps have their bits in one word (lamp_looks.glsl).
#define LAMPS_IN_GROUP 32u

// Samples along each side of an area light's rectangle: of a lobe or a pixel, and of a probe.
#define AREA_SAMPLES_OF_SURFACE 6
#define AREA_SAMPLES_OF_PROBE 16
// Rows of them that a dispatch sums up (direct_light.glsl says why not all).
#define AREA_ROWS_AT_ONCE 2

// One light. Fields that a kind does not use are zero.
#define LIGHT_POINT 0u
#define LIGHT_SPOT 1u
#define LIGHT_AREA 2u
struct Light {
    vec4 position;    // xyz: m, relative to the octree's origin (area: the first corner)
    vec4 intensity;   // rgb: W/sr, on the axis for a spot (area: radiance, W/sr/m2)
    vec4 axis;        // xyz: unit direction of a spot, or the normal of an area's emitting side
                      // w: cosine of a spot's half angle
    vec4 edge_u;      // xyz: area: first corner to second, m; w: a spot's blend
    vec4 edge_v;      // xyz: area: first corner to fourth, m
    uint kind;        // LIGHT_*
    uint tag;         // area: what its lobes carry in `light`, 0 where the octree has none
    uint unused_0;
    uint unused_1;
};

#ifdef __cplusplus
}  // namespace glowworm::gpu
#endif
#endif

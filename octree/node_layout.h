#pragma once

#include <cstddef>
#include <cstdint>

// What lies in an .svo file, byte for byte: disk = memory = GPU. Only 4-byte scalars inside records
// that the GPU reads, so that std430 and C++ agree. FORMAT.md is the page for people who write
// their own reader; a change here bumps kFormatVersion and that page together.

namespace glowworm {

inline constexpr std::uint32_t kFormatVersion = 1;
inline constexpr std::uint32_t kMaxDepth = 21;
inline constexpr std::size_t kSectionAlignment = 4096;
inline constexpr char kMagic[8] = {'G', 'L', 'O', 'W', 'S', 'V', 'O', '\n'};

enum class SectionKind : std::uint32_t {
    kLevels = 1,       ///< [depth+1] Level
    kNodes = 2,        ///< Node, breadth-first, Morton order inside each level
    kAttributes = 3,   ///< NodeAttributes, parallel to the nodes
    kLobes = 4,        ///< Lobe, in the order of their leaves
    kChunks = 5,       ///< Chunk, in Morton order
    kSurfels = 6,      ///< PackedSurfel, chunk after chunk
    kStations = 7,     ///< StationRecord
    kAreaLights = 8,   ///< AreaLightRecord
    kNames = 9,        ///< UTF-8 text that stations and lights point into
    kProvenance = 10,  ///< UTF-8 JSON: command, version, inputs
    kLinks = 11,       ///< optional: uint32 [lobes][links per lobe], hit lobe, kNoHit or kBuried
};

struct SectionEntry {
    std::uint32_t kind;          ///< SectionKind
    std::uint32_t record_bytes;  ///< size of one record
    std::uint64_t offset;        ///< bytes from the file's start, a multiple of 4096
    std::uint64_t count;         ///< records
    std::uint64_t checksum;      ///< XXH3-64 of the section's bytes
};
static_assert(sizeof(SectionEntry) == 32);

inline constexpr std::size_t kMaxSections = 16;

/// The first bytes of a file; the first section starts at the next multiple of 4096.
struct FileHeader {
    char magic[8];
    std::uint32_t version;
    std::uint32_t depth;       ///< level of the leaves; the root is level 0
    std::uint64_t file_bytes;  ///< the whole file: a shorter one was truncated
    double origin[3];          ///< m, world; everything else is relative to it
    float cube_min[3];         ///< m, relative to origin: the root cell's lower corner
    float cube_edge;           ///< m: the root cell's edge; a leaf's is cube_edge / 2^depth
    float bounds_min[3];       ///< m, relative to origin: the surfels' tight box
    float bounds_max[3];
    std::uint64_t sample_count;    ///< surfels that went in
    std::uint64_t dropped_count;   ///< surfels left out because they were not finite
    std::uint32_t links_per_lobe;  ///< 0 where there is no link section
    std::uint32_t section_count;
    SectionEntry sections[kMaxSections];
    std::uint64_t checksum;  ///< XXH3-64 of all header bytes before this one
};
static_assert(offsetof(FileHeader, sections) % 8 == 0);
static_assert(sizeof(FileHeader) <= kSectionAlignment);

struct Level {
    std::uint32_t first_node;
    std::uint32_t node_count;
};

/// An inner node's bits 0..7 of `mask` are its child mask (octant = x + 2y + 4z) and its children
/// are the consecutive nodes from `first` (Laine and Karras 2010). A leaf (level = depth) has a
/// zero child mask, its lobe count in bits 8..9 (1 to 3: up to two of the surface, then at most one
/// that emits), and its lobes start at `first`.
struct Node {
    std::uint32_t mask;
    std::uint32_t first;
};

/// What a cell holds on the whole, for statistics and for the cones' coarse levels.
struct NodeAttributes {
    float opacity;    ///< coverage of the cell's cross-section along its most covered axis, 0..1
    float area;       ///< m², surface area inside the cell
    float ndf[3];     ///< area-weighted mean normal; its length is the Toksvig length
    float albedo[3];  ///< linear Rec.709, area-weighted
};
static_assert(sizeof(NodeAttributes) == 32);

/// One side of a leaf's surface: the light lives on these.
struct Lobe {
    float position[3];        ///< m, relative to origin: area-weighted mean of its samples
    float area;               ///< m²
    float ndf[3];             ///< area-weighted mean normal; its length is the Toksvig length
    float plane_sigma;        ///< m: rms distance of the samples from the lobe's plane
    float albedo[3];          ///< linear Rec.709
    std::uint32_t light;      ///< 0: none, else 1 + index of the area light it belongs to
    std::uint32_t patch_min;  ///< 3 x 8 bits x, y, z from the low end, in 1/255 of the leaf's edge
                              ///< from its lower corner, rounded down
    std::uint32_t patch_max;  ///< 3 x 8 bits, rounded up
    std::uint32_t emission;   ///< radiance, RGB9E5 (r in the low 9 bits, exponent in the high 5)
    float spacing;            ///< m: mean spacing of the samples, sqrt(area per sample)
};
static_assert(sizeof(Lobe) == 64);

/// A ray that meets nothing, and one that ran into a surface from behind: it began inside or slipped
/// through, so it says nothing about the light.
inline constexpr std::uint32_t kNoHit = 0xffffffffu;
inline constexpr std::uint32_t kBuried = 0xfffffffeu;

inline constexpr std::uint32_t kMaxChunkSurfels = 65536;

/// A subtree's surfels. Inside a chunk they lie in level-of-detail order: any prefix is an even
/// subsample of the whole. The box is a cell of the octree's grid (level 0 to 15) and positions are
/// truncated, not rounded: a chunk's surfels can be counted from a larger cell by a shift.
struct Chunk {
    float box_min[3];     ///< m, relative to origin: what quantised positions count from
    float box_edge;       ///< m: a position is box_min + (q + 0.5) / 65536 · box_edge
    std::uint32_t first;  ///< first surfel
    std::uint32_t count;
    float spacing;     ///< m: mean spacing of all its surfels
    float max_radius;  ///< m
};
static_assert(sizeof(Chunk) == 32);

/// 20 bytes a point.
struct PackedSurfel {
    std::uint32_t position_xy;        ///< low 16 bits x, high y: in 1/65536 of the chunk's edge
    std::uint32_t position_z_radius;  ///< low 16 bits z, high: radius, IEEE half, m
    std::uint32_t normal;             ///< octahedral, x low, y high: unpackSnorm2x16 of GLSL
    std::uint32_t albedo_ndf;     ///< r, g, b sRGB-encoded 8 bits each from the low end, then NDF
                                  ///< length in 1/255
    std::uint32_t station_light;  ///< low 16 bits station, high: 0 or 1 + area light
};
static_assert(sizeof(PackedSurfel) == 20);

struct StationRecord {
    double position[3];  ///< m, world
    double rotation[4];  ///< quaternion x y z w
    std::uint32_t has_viewpoint;
    std::uint32_t name_offset;  ///< bytes into the names section
    std::uint32_t name_bytes;
    std::uint32_t unused;
};
static_assert(sizeof(StationRecord) == 72);

struct AreaLightRecord {
    double corners[12];  ///< 4 x (x, y, z), m, world
    float radiance[3];   ///< W·sr⁻¹·m⁻²
    std::uint32_t name_offset;
    std::uint32_t name_bytes;
    std::uint32_t unused;
};
static_assert(sizeof(AreaLightRecord) == 120);

}  // namespace glowworm

#pragma once

// What splat_pass.cpp and rim_pass.cpp draw in; theirs alone.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "viewer/frame/splat_pass.h"
#include "viewer/frame/tile_bins.h"
#include "viewer/gpu/glsl.h"
#include "viewer/gpu/lanes.h"

namespace glowworm {

inline PixelBox pixel_box(const glm::ivec4& box) {
    const auto narrow = [](int value) { return static_cast<std::int16_t>(value); };
    return {narrow(box.x), narrow(box.y), narrow(box.z), narrow(box.w)};
}

namespace gpu {

/// What the shaders bind, and what they compute with it.
struct SplatTopics {
    ViewBlock view{};
    std::array<float, 256> linear{};  // of an sRGB byte
    std::span<float> depths, rims;    // [pixels] m
    std::span<const int> weights;     // [pixels] of all discs at a pixel
    std::span<uint> tiles;            // [squares of RIM_TILE] 1: holds a rim
    std::span<const float> sight;     // DepthPyramid::finest(); empty before anything is drawn

#define IS_HIDDEN(centre, radius) is_hidden(centre, radius)
#define LINEAR_FROM_SRGB(value) linear[value]
#include "shaders/rim_tiles.glsl"
#include "shaders/rims.glsl"
#include "shaders/splat.glsl"
#include "shaders/surface_sums.glsl"
#include "shaders/surfel.glsl"
#include "shaders/view.glsl"
    /// Whether what is drawn so far hides all of a sphere. Of those that span many squares, no.
    bool is_hidden(vec3 centre, float radius) const {
        constexpr float kMostPixels = 2.0f * DEPTH_TILE;
        const float nearest = centre.z - radius;
        if (sight.empty() || nearest <= kNearDepth) return false;
        const vec2 axis(view.down.w, view.forward.w);
        vec2 reach(radius * view.position.w), middle = axis + vec2(centre) * view.position.w;
        if (view.right.w <= 0.5f) {  // a pinhole
            reach = reach / nearest * (1.0f + abs(vec2(centre)) / centre.z);
            middle = axis + vec2(centre) * (view.position.w / centre.z);
        }
        if (max(reach.x, reach.y) > kMostPixels) return false;
        const int columns = static_cast<int>((view.width + DEPTH_TILE - 1) / DEPTH_TILE);
        const int rows = static_cast<int>((view.height + DEPTH_TILE - 1) / DEPTH_TILE);
        const ivec2 last(columns - 1, rows - 1);
        const ivec2 low = clamp(ivec2((middle - reach) / float(DEPTH_TILE)), ivec2(0), last);
        const ivec2 high = clamp(ivec2((middle + reach) / float(DEPTH_TILE)), ivec2(0), last);
        for (int y = low.y; y <= high.y; ++y) {
            for (int x = low.x; x <= high.x; ++x) {
                if (sight[static_cast<std::size_t>(y * columns + x)] + radius >= nearest)
                    return false;
            }
        }
        return true;
    }
    /// As far as a disc closes gaps.
    PixelBox grown_box(const Splat& splat) {
        return pixel_box(splat_box(splat, kGapGrowth));
    }
    /// Whether a rim lies round `box`, which is all of a disc's: farther than the disc grows, or it
    /// is not known how far that is.
    bool may_close_gaps(const PixelBox& box) {
        const int width = box.high_x - box.low_x + 1, height = box.high_y - box.low_y + 1;
        const int right = static_cast<int>(view.width) - 1;
        const int bottom = static_cast<int>(view.height) - 1;
        // What is cut off by the picture's border is not known, nor how near the eye a disc comes
        // that spans a wide angle.
        if (box.empty() || box.low_x <= 0 || box.low_y <= 0 || box.high_x >= right ||
            box.high_y >= bottom || 4.0f * static_cast<float>(max(width, height)) > view.position.w)
            return true;
        return any_rim({max(box.low_x - width, 0), max(box.low_y - height, 0),
                        min(box.high_x + width, right), min(box.high_y + height, bottom)});
    }
    bool is_solid(uint pixel) {
        return float(weights[pixel]) >= kRimCover * kFixedOne;
    }
    float depth_at(uint pixel) {
        return depths[pixel];
    }
    float rim_at(uint pixel) {
        return rims[pixel];
    }
    bool is_empty(uint pixel) {
        return std::isinf(depths[pixel]);
    }
#include "shaders/rim_borders.glsl"
#include "shaders/rim_search.glsl"
};

/// A disc and what it looks like, in one line of a cache.
struct alignas(64) SplatDisc {
    SplatTopics::Splat splat;
    vec3 normal;      // camera space
    uint albedo_ndf;  // PackedSurfel's
    PixelBox box;     // as far as the radius
};

}  // namespace gpu

using gpu::uint;

inline constexpr float kFarthest = std::numeric_limits<float>::infinity();
inline constexpr int kTile = TileBins::kTile;
static_assert(kTile == WIDTH_TILE && WIDTH_TILE == DEPTH_TILE * DepthPyramid::kWidthTiles);
inline constexpr std::size_t kBatchesPerTask = 16;
inline constexpr std::size_t kFirstBatches = 256;  // drawn before it is asked what they hide

/// A batch and the page that it lies in.
struct PagedBatch {
    gpu::SplatBatch batch;
    std::span<const PackedSurfel> page;
};

/// Discs in the order of their surfels, a run for kBatchesPerTask batches, of which the first
/// `used` are any. Memory that no disc needs is not touched.
struct SplatDiscs {
    static constexpr std::size_t kRun = kBatchesPerTask * SPLAT_GROUP;

    std::unique_ptr<gpu::SplatDisc[]> discs;
    std::unique_ptr<PixelBox[]> boxes;  // as far as the radius
    std::size_t capacity = 0;           // runs
    std::vector<std::uint32_t> used;    // [runs]
    TileBins bins;                      // of boxes

    void begin(std::size_t runs) {
        used.assign(runs, 0);
        if (runs <= capacity) return;
        capacity = runs + runs / 4;
        discs = std::make_unique_for_overwrite<gpu::SplatDisc[]>(capacity * kRun);
        boxes = std::make_unique_for_overwrite<PixelBox[]>(capacity * kRun);
    }
    TileBins binned(const PixelBox* of, const gpu::ViewBlock& view) const {
        return {std::span(of, used.size() * kRun), kRun, used, static_cast<int>(view.width),
                static_cast<int>(view.height)};
    }
    /// Calls `visit(disc)` for those in a bin. They lie all over memory: a chunk's surfels go from
    /// coarse to fine.
    template <typename Visit>
    void for_each(std::span<const std::uint32_t> bin, const Visit& visit) const {
        constexpr std::size_t kAhead = 12;
        for (std::size_t i = 0; i < bin.size(); ++i) {
            if (i + kAhead < bin.size()) __builtin_prefetch(&discs[bin[i + kAhead]]);
            visit(discs[bin[i]]);
        }
    }
};

inline constexpr int kTileGroups = kTile / gpu::kLanes;  // of pixels in a tile's row

/// A square of the picture, which one thread draws.
struct SplatTile {
    std::size_t index;
    int left, top, right, bottom;  // pixels, both ends included

    /// The group of kLanes pixels that holds (x, y).
    std::size_t group(int x, int y) const {
        return static_cast<std::size_t>((y - top) * kTileGroups + (x - left) / gpu::kLanes);
    }
    std::size_t lane(int x) const { return static_cast<std::size_t>(x - left) % gpu::kLanes; }
    PixelBox clipped(const PixelBox& box) const {
        return {static_cast<std::int16_t>(std::max<int>(box.low_x, left)),
                static_cast<std::int16_t>(std::max<int>(box.low_y, top)),
                static_cast<std::int16_t>(std::min<int>(box.high_x, right)),
                static_cast<std::int16_t>(std::min<int>(box.high_y, bottom))};
    }
    PixelBox all() const { return clipped({0, 0, INT16_MAX, INT16_MAX}); }
};

/// Something for each group of kLanes pixels in a square.
template <typename T>
using SplatGroups = std::array<T, std::size_t{kTile} * kTileGroups>;
using SplatShare = gpu::SplatTopics::SurfaceShare;

inline void add_to(SplatShare& sums, const SplatShare& more) {
    sums.normal_x += more.normal_x;
    sums.normal_y += more.normal_y;
    sums.normal_z += more.normal_z;
    sums.weight += more.weight;
    sums.red += more.red;
    sums.green += more.green;
    sums.blue += more.blue;
    sums.ndf_length += more.ndf_length;
    sums.behind += more.behind;
}

template <typename Visit>
void for_each_pixel(const PixelBox& box, const Visit& visit) {
    for (int y = box.low_y; y <= box.high_y; ++y) {
        for (int x = box.low_x; x <= box.high_x; ++x)
            visit(x, y);
    }
}

/// The frame that is drawn: depths and rims of all pixels; sums only while a square is drawn.
struct SplatPass::Picture {
    gpu::SplatTopics topics;
    int columns = 0, rows = 0;            // of tiles
    std::vector<float> depths, rims;      // [pixels]
    std::vector<int> weights;             // [pixels]
    std::vector<uint> rim_squares;        // [squares of RIM_TILE]
    std::vector<std::uint32_t> rim_bits;  // [tiles * kTile] a bit a pixel of a row: it is a rim
    std::vector<uint> widths;             // [tiles] pixels: of the widest disc that touches one
    std::optional<DepthPyramid> pyramid;  // of what is drawn; none before anything is
    std::vector<SplatDiscs> parts;
    std::size_t used = 0;  // of them, in this frame

    SplatTile tile(std::size_t index) const {
        const int left = static_cast<int>(index) % columns * kTile;
        const int top = static_cast<int>(index) / columns * kTile;
        return {index, left, top, std::min(left + kTile, static_cast<int>(topics.view.width)) - 1,
                std::min(top + kTile, static_cast<int>(topics.view.height)) - 1};
    }
    std::size_t pixel(int x, int y) const {
        return static_cast<std::size_t>(y) * topics.view.width + static_cast<std::size_t>(x);
    }
    /// On all cores; each task with topics of its own.
    template <typename Visit>
    void for_each_tile(const Visit& visit) const {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, static_cast<std::size_t>(columns) *
                                                                 static_cast<std::size_t>(rows)),
                          [&](const auto& range) {
                              gpu::SplatTopics own = topics;
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  visit(tile(i), own);
                          });
    }
    void make_discs(SplatDiscs& part, std::span<const gpu::DrawnChunk> chunks,
                    std::span<const PagedBatch> batches) const;
    void draw(std::span<const gpu::DrawnChunk> chunks, std::span<const PagedBatch> batches);
    std::vector<float> farthest_tiles() const;
    void look();
    SplatGroups<gpu::Floats> depths_of(const SplatTile& tile) const;
    void find_nearest(const SplatTile& tile, gpu::SplatTopics& own, const SplatDiscs& part);
    void blend(const SplatTile& tile, gpu::SplatTopics& own, SplatGroups<SplatShare>& sums) const;
    bool find_rims(const SplatTile& tile, gpu::SplatTopics& own);
    void open_rims(const SplatTile& tile, gpu::SplatTopics& own, std::span<const TileBins> bins,
                   SplatGroups<SplatShare>& sums);
    void resolve(const SplatTile& tile, gpu::SplatTopics& own, const SplatGroups<SplatShare>& sums,
                 int x, int y, std::span<gpu::vec4> surfaces, std::span<gpu::vec4> albedos);
};

}  // namespace glowworm

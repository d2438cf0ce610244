#include "viewer/frame/splat_pass.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "viewer/frame/tile_bins.h"
#include "viewer/gpu/glsl.h"
#include "viewer/gpu/lanes.h"

namespace glowworm {
namespace gpu {
namespace {

/// What the shaders bind, and what they compute with it.
struct SplatTopics {
    ViewBlock view{};
    std::array<float, 256> linear{};  // of an sRGB byte
    std::span<float> depths, rims;    // [pixels] m
    std::span<const int> weights;     // [pixels] of all discs at a pixel
    std::span<uint> tiles;            // [squares of RIM_TILE] 1: holds a rim

#define LINEAR_FROM_SRGB(value) linear[value]
#include "shaders/rim_tiles.glsl"
#include "shaders/rims.glsl"
#include "shaders/splat.glsl"
#include "shaders/surface_sums.glsl"
#include "shaders/surfel.glsl"
#include "shaders/view.glsl"
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

struct alignas(64) Disc {
    SplatTopics::Splat splat;
    vec3 normal;      // camera space
    uint albedo_ndf;  // PackedSurfel's
    PixelBox box;     // as far as the radius
};

}  // namespace
}  // namespace gpu

namespace {

using gpu::Disc;
using gpu::SplatTopics;
using gpu::uint;

constexpr float kFarthest = std::numeric_limits<float>::infinity();
constexpr int kTile = TileBins::kTile;
constexpr std::size_t kBatchesPerTask = 16;
constexpr PixelBox kNowhere{0, 0, -1, -1};

PixelBox pixel_box(const glm::ivec4& box) {
    const auto narrow = [](int value) { return static_cast<std::int16_t>(value); };
    return {narrow(box.x), narrow(box.y), narrow(box.z), narrow(box.w)};
}

/// Discs in the order of their surfels, a run for kBatchesPerTask batches, of which the first
/// `used` are any. Memory that no disc needs is not touched.
struct Discs {
    static constexpr std::size_t kRun = kBatchesPerTask * SPLAT_GROUP;

    std::unique_ptr<Disc[]> discs;
    std::unique_ptr<PixelBox[]> boxes, grown;  // as far as the radius; as far as they close gaps
    std::size_t capacity = 0;                  // runs
    std::vector<std::uint32_t> used;           // [runs]
    TileBins bins;                             // of boxes

    void begin(std::size_t runs) {
        used.assign(runs, 0);
        if (runs <= capacity) return;
        capacity = runs + runs / 4;
        discs = std::make_unique_for_overwrite<Disc[]>(capacity * kRun);
        boxes = std::make_unique_for_overwrite<PixelBox[]>(capacity * kRun);
        grown = std::make_unique_for_overwrite<PixelBox[]>(capacity * kRun);
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

constexpr int kGroups = kTile / gpu::kLanes;  // of pixels in a tile's row

struct Tile {
    std::size_t index;
    int left, top, right, bottom;  // pixels, both ends included

    /// The group of kLanes pixels that holds (x, y).
    std::size_t group(int x, int y) const {
        return static_cast<std::size_t>((y - top) * kGroups + (x - left) / gpu::kLanes);
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

template <typename T>
using Groups = std::array<T, std::size_t{kTile} * kGroups>;
using Share = SplatTopics::SurfaceShare;

void add_to(Share& sums, const Share& more) {
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

/// Calls `visit(group, depth, off)` for the groups that hold `box`, a part of `tile`, with what
/// splat_at() gives there.
template <typename Visit>
void for_each_hit(SplatTopics& own, const SplatTopics::Splat& splat, const PixelBox& box,
                  const Tile& tile, const Visit& visit) {
    if (box.empty()) return;
    const int first = tile.left + (box.low_x - tile.left) / gpu::kLanes * gpu::kLanes;
    const gpu::Floats middles = gpu::Floats{0.5f, 1.5f, 2.5f, 3.5f} + static_cast<float>(first);
    for (int y = box.low_y; y <= box.high_y; ++y) {
        const gpu::Floats row = static_cast<float>(y) + 0.5f + gpu::Floats{};
        gpu::Floats x = middles;
        std::size_t group = tile.group(first, y);
        for (int left = first; left <= box.high_x; left += gpu::kLanes) {
            gpu::Floats depth, off;
            own.splat_at(splat, x, row, depth, off);
            visit(group, depth, off);
            x += static_cast<float>(gpu::kLanes);
            ++group;
        }
    }
}

}  // namespace

struct SplatPass::Picture {
    SplatTopics topics;
    int columns = 0, rows = 0;            // of tiles
    std::vector<float> depths, rims;      // [pixels]
    std::vector<int> weights;             // [pixels]
    std::vector<uint> rim_squares;        // [squares of RIM_TILE]
    std::vector<std::uint32_t> rim_bits;  // [tiles * kTile] a bit a pixel of a row: it is a rim
    std::vector<Discs> parts;             // one an add()
    std::size_t used = 0;                 // of them, in this frame

    Tile tile(std::size_t index) const {
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
                              SplatTopics own = topics;
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  visit(tile(i), own);
                          });
    }
    void make_discs(Discs& part, const SplatInput& input, std::size_t first_draw);
    Groups<gpu::Floats> depths_of(const Tile& tile) const;
    void find_nearest(const Tile& tile, SplatTopics& own, const Discs& part);
    void blend(const Tile& tile, SplatTopics& own, Groups<Share>& sums) const;
    bool find_rims(const Tile& tile, SplatTopics& own);
    void open_rims(const Tile& tile, SplatTopics& own, std::span<const TileBins> bins,
                   Groups<Share>& sums);
    void resolve(const Tile& tile, SplatTopics& own, const Groups<Share>& sums, int x, int y,
                 std::span<gpu::vec4> surfaces, std::span<gpu::vec4> albedos);
};

SplatPass::SplatPass() : picture_(std::make_unique<Picture>()) {
    SplatTopics& topics = picture_->topics;
    for (uint value = 0; value < topics.linear.size(); ++value)
        topics.linear[value] = topics.linear_from_srgb(value);
}

SplatPass::~SplatPass() = default;

void SplatPass::begin(const gpu::ViewBlock& view) {
    Picture& p = *picture_;
    const std::size_t pixels = std::size_t{view.width} * view.height;
    p.topics.view = view;
    p.columns = (static_cast<int>(view.width) + kTile - 1) / kTile;
    p.rows = (static_cast<int>(view.height) + kTile - 1) / kTile;
    p.depths.assign(pixels, kFarthest);
    p.rims.resize(pixels);
    p.weights.resize(pixels);
    p.rim_squares.resize(std::size_t{(view.width + RIM_TILE - 1) / RIM_TILE} *
                         ((view.height + RIM_TILE - 1) / RIM_TILE));
    p.rim_bits.resize(static_cast<std::size_t>(p.columns * p.rows) * kTile);
    p.topics.depths = p.depths;
    p.topics.rims = p.rims;
    p.topics.weights = p.weights;
    p.topics.tiles = p.rim_squares;
    p.used = 0;
}

void SplatPass::Picture::make_discs(Discs& part, const SplatInput& input, std::size_t first_draw) {
    std::vector<std::size_t> first_run;  // of each draw
    std::size_t runs = 0;
    for (const PageDraw& draw : input.draws.subspan(first_draw)) {
        first_run.push_back(runs);
        runs += (draw.batch_count + kBatchesPerTask - 1) / kBatchesPerTask;
    }
    part.begin(runs);
    for (std::size_t d = first_draw; d < input.draws.size(); ++d) {
        const PageDraw& draw = input.draws[d];
        const auto page = input.pages[draw.page].map<const PackedSurfel>();
        const std::span<const PackedSurfel> surfels = page;
        const auto batches = input.batches.subspan(draw.first_batch, draw.batch_count);
        const std::size_t first = first_run[d - first_draw];
        const std::size_t last = d + 1 < input.draws.size() ? first_run[d + 1 - first_draw] : runs;
        tbb::parallel_for(first, last, [&](std::size_t run) {
            SplatTopics own = topics;
            std::size_t slot = run * Discs::kRun;
            const std::size_t begin = (run - first) * kBatchesPerTask;
            for (const gpu::SplatBatch& batch :
                 batches.subspan(begin, std::min(kBatchesPerTask, batches.size() - begin))) {
                for (uint i = 0; i < batch.count; ++i) {
                    const PackedSurfel& surfel = surfels[batch.first + i];
                    Disc& disc = part.discs[slot];
                    if (!own.splat_of(surfel, batch.rank + i, input.chunks[batch.chunk],
                                      disc.splat))
                        continue;
                    part.grown[slot] = pixel_box(own.splat_box(disc.splat, own.kGapGrowth));
                    if (part.grown[slot].empty()) continue;
                    disc.box = pixel_box(own.splat_box(disc.splat, 1.0f));
                    part.boxes[slot] = disc.box;
                    disc.normal = own.camera_from_octree_direction(own.surfel_normal(surfel));
                    disc.albedo_ndf = surfel.albedo_ndf;
                    ++slot;
                }
            }
            part.used[run] = static_cast<std::uint32_t>(slot - run * Discs::kRun);
        });
    }
}

Groups<gpu::Floats> SplatPass::Picture::depths_of(const Tile& tile) const {
    Groups<gpu::Floats> tile_depths{};
    for_each_pixel(tile.all(), [&](int x, int y) {
        tile_depths[tile.group(x, y)][tile.lane(x)] = depths[pixel(x, y)];
    });
    return tile_depths;
}

void SplatPass::Picture::find_nearest(const Tile& tile, SplatTopics& own, const Discs& part) {
    Groups<gpu::Floats> nearest = depths_of(tile);
    part.for_each(part.bins.of(tile.index), [&](const Disc& disc) {
        for_each_hit(own, disc.splat, tile.clipped(disc.box), tile,
                     [&](std::size_t group, gpu::Floats depth, gpu::Floats off) {
                         const gpu::Floats is = nearest[group];
                         nearest[group] = (depth > 0.0f) & (off < 1.0f) & (depth < is) ? depth : is;
                     });
    });
    for_each_pixel(tile.all(), [&](int x, int y) {
        depths[pixel(x, y)] = nearest[tile.group(x, y)][tile.lane(x)];
    });
}

void SplatPass::add(const SplatInput& input, std::size_t first_draw) {
    Picture& p = *picture_;
    if (p.used == p.parts.size()) p.parts.emplace_back();
    Discs& part = p.parts[p.used++];
    p.make_discs(part, input, first_draw);
    part.bins = part.binned(part.boxes.get(), p.topics.view);
    p.for_each_tile([&](const Tile& tile, SplatTopics& own) { p.find_nearest(tile, own, part); });
}

std::vector<float> SplatPass::farthest_tiles() const {
    const Picture& p = *picture_;
    const int width = static_cast<int>(p.topics.view.width);
    const int height = static_cast<int>(p.topics.view.height);
    const int columns = (width + DEPTH_TILE - 1) / DEPTH_TILE;
    const int rows = (height + DEPTH_TILE - 1) / DEPTH_TILE;
    std::vector<float> farthest(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    tbb::parallel_for(0, rows, [&](int row) {
        float* tiles = &farthest[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns)];
        for (int y = row * DEPTH_TILE; y < std::min((row + 1) * DEPTH_TILE, height); ++y) {
            for (int x = 0; x < width; ++x) {
                float& tile = tiles[x / DEPTH_TILE];
                tile = std::max(tile, p.depths[p.pixel(x, y)]);
            }
        }
    });
    return farthest;
}

void SplatPass::Picture::blend(const Tile& tile, SplatTopics& own, Groups<Share>& sums) const {
    const Groups<gpu::Floats> nearest = depths_of(tile);
    for (const Discs& part : std::span(parts).first(used)) {
        part.for_each(part.bins.of(tile.index), [&](const Disc& disc) {
            const glm::vec3 albedo = own.surfel_albedo({.albedo_ndf = disc.albedo_ndf});
            const float ndf_length = own.surfel_ndf_length({.albedo_ndf = disc.albedo_ndf});
            for_each_hit(own, disc.splat, tile.clipped(disc.box), tile,
                         [&](std::size_t group, gpu::Floats depth, gpu::Floats off) {
                             const gpu::Floats behind = depth - nearest[group];
                             const gpu::Ints counts =
                                 (depth > 0.0f) & (behind <= disc.splat.radius) & (off < 1.0f);
                             if (!gpu::any_of(counts)) return;
                             const gpu::Floats weight = own.splat_weight(off, 1.0f);
                             add_to(sums[group], own.share_of_surface(
                                                     counts ? weight : 0.0f, disc.normal, albedo,
                                                     ndf_length, counts ? behind : 0.0f));
                         });
        });
    }
}

void SplatPass::Picture::resolve(const Tile& tile, SplatTopics& own, const Groups<Share>& sums,
                                 int x, int y, std::span<gpu::vec4> surfaces,
                                 std::span<gpu::vec4> albedos) {
    const Share& sum = sums[tile.group(x, y)];
    const std::size_t i = tile.lane(x), at = pixel(x, y);
    const glm::ivec4 normal{sum.normal_x[i], sum.normal_y[i], sum.normal_z[i], sum.weight[i]};
    surfaces[at] = own.mean_surface(normal, sum.behind[i], depths[at]);
    albedos[at] =
        own.mean_albedo(normal, {sum.red[i], sum.green[i], sum.blue[i], sum.ndf_length[i]});
    weights[at] = sum.weight[i];
}

void SplatPass::blend(std::span<gpu::vec4> surfaces, std::span<gpu::vec4> albedos) {
    Picture& p = *picture_;
    p.for_each_tile([&](const Tile& tile, SplatTopics& own) {
        Groups<Share> sums{};
        p.blend(tile, own, sums);
        for_each_pixel(tile.all(),
                       [&](int x, int y) { p.resolve(tile, own, sums, x, y, surfaces, albedos); });
    });
}

/// Whether there are any.
bool SplatPass::Picture::find_rims(const Tile& tile, SplatTopics& own) {
    const auto squares = (topics.view.width + RIM_TILE - 1) / RIM_TILE;
    bool any = false;
    for (int y = tile.top; y <= tile.bottom; ++y) {
        std::uint32_t bits = 0;
        for (int x = tile.left; x <= tile.right; ++x) {
            const auto at = static_cast<uint>(pixel(x, y));
            rims[at] = 0.0f;
            if (own.is_solid(at)) continue;
            rims[at] = own.find_rim({x, y}, weights[at] > 0 ? depths[at] : 0.0f);
            if (rims[at] == 0.0f) continue;
            bits |= 1u << (x - tile.left);
            rim_squares[static_cast<uint>(y) / RIM_TILE * squares +
                        static_cast<uint>(x) / RIM_TILE] = 1;
        }
        rim_bits[tile.index * kTile + static_cast<std::size_t>(y - tile.top)] = bits;
        any |= bits != 0;
    }
    return any;
}

void SplatPass::Picture::open_rims(const Tile& tile, SplatTopics& own,
                                   std::span<const TileBins> bins, Groups<Share>& sums) {
    const std::uint32_t* rows_bits = &rim_bits[tile.index * kTile];
    const auto for_each_rim = [&](const PixelBox& whole, const auto& visit) {
        const PixelBox box = tile.clipped(whole);
        if (box.empty()) return;
        const int first = box.low_x - tile.left, last = box.high_x - tile.left;
        const std::uint32_t columns_bits = (~0u << first) & (~0u >> (kTile - 1 - last));
        for (int y = box.low_y; y <= box.high_y; ++y) {
            for (std::uint32_t bits = rows_bits[y - tile.top] & columns_bits; bits != 0;
                 bits &= bits - 1)
                visit(tile.left + std::countr_zero(bits), y);
        }
    };
    const auto for_each_disc = [&](const auto& visit) {
        for (std::size_t i = 0; i < bins.size(); ++i) {
            for (const std::uint32_t index : bins[i].of(tile.index)) {
                const Disc disc = parts[i].discs[index];
                for_each_rim(parts[i].grown[index], [&](int x, int y) {
                    gpu::Floats depth, off;
                    own.splat_at(disc.splat, static_cast<float>(x) + 0.5f + gpu::Floats{},
                                 static_cast<float>(y) + 0.5f + gpu::Floats{}, depth, off);
                    if (depth[0] > 0.0f) visit(disc, depth[0], off[0], x, y);
                });
            }
        }
    };
    for_each_rim(tile.all(), [&](int x, int y) { depths[pixel(x, y)] = kFarthest; });
    for_each_disc([&](const Disc& disc, float depth, float off, int x, int y) {
        float& nearest = depths[pixel(x, y)];
        const float most = own.reach_behind(rims[pixel(x, y)], depth, disc.splat.radius);
        if (off < most) nearest = std::min(nearest, depth);
    });
    for_each_rim(tile.all(), [&](int x, int y) {
        const auto at = static_cast<uint>(pixel(x, y));
        if (own.keeps_rim(at, {x, y})) depths[at] = rims[at];
    });
    for_each_disc([&](const Disc& disc, float depth, float off, int x, int y) {
        const float behind = depth - depths[pixel(x, y)];
        const float most = own.reach_beside(rims[pixel(x, y)], behind, disc.splat.radius);
        if (behind > disc.splat.radius || off >= most) return;
        gpu::Floats weight{};
        weight[tile.lane(x)] = own.splat_weight(off + gpu::Floats{}, most)[0];
        add_to(sums[tile.group(x, y)],
               own.share_of_surface(
                   weight, disc.normal, own.surfel_albedo({.albedo_ndf = disc.albedo_ndf}),
                   own.surfel_ndf_length({.albedo_ndf = disc.albedo_ndf}), behind + gpu::Floats{}));
    });
}

void SplatPass::open_rims(std::span<gpu::vec4> surfaces, std::span<gpu::vec4> albedos) {
    Picture& p = *picture_;
    std::vector<char> opened(static_cast<std::size_t>(p.columns * p.rows));
    std::ranges::fill(p.rim_squares, 0u);
    p.for_each_tile([&](const Tile& tile, SplatTopics& own) {
        opened[tile.index] = p.find_rims(tile, own) ? 1 : 0;
    });
    if (std::ranges::count(opened, 1) == 0) return;

    std::vector<TileBins> bins;
    for (const Discs& part : std::span(p.parts).first(p.used)) {
        const auto near =
            std::make_unique_for_overwrite<PixelBox[]>(part.used.size() * Discs::kRun);
        tbb::parallel_for(std::size_t{0}, part.used.size(), [&](std::size_t run) {
            SplatTopics own = p.topics;
            for (std::size_t i = run * Discs::kRun; i < run * Discs::kRun + part.used[run]; ++i) {
                const PixelBox& box = part.grown[i];
                near[i] =
                    own.any_rim({box.low_x, box.low_y, box.high_x, box.high_y}) ? box : kNowhere;
            }
        });
        bins.push_back(part.binned(near.get(), p.topics.view));
    }
    p.for_each_tile([&](const Tile& tile, SplatTopics& own) {
        if (opened[tile.index] == 0) return;
        Groups<Share> sums{};
        p.open_rims(tile, own, bins, sums);
        for (int y = tile.top; y <= tile.bottom; ++y) {
            std::uint32_t bits =
                p.rim_bits[tile.index * kTile + static_cast<std::size_t>(y - tile.top)];
            for (; bits != 0; bits &= bits - 1) {
                p.resolve(tile, own, sums, tile.left + std::countr_zero(bits), y, surfaces,
                          albedos);
            }
        }
    });
}

}  // namespace glowworm

#include "viewer/frame/splat_pass.h"

#include <utility>

#include "viewer/frame/splat_picture.h"

namespace glowworm {
namespace {

PixelBox pixel_box(const glm::ivec4& box) {
    const auto narrow = [](int value) { return static_cast<std::int16_t>(value); };
    return {narrow(box.x), narrow(box.y), narrow(box.z), narrow(box.w)};
}

/// Calls `visit(group, depth, off)` for the groups that hold `box`, a part of `tile`, with what
/// splat_at() gives there.
template <typename Visit>
void for_each_hit(gpu::SplatTopics& own, const gpu::SplatTopics::Splat& splat, const PixelBox& box,
                  const SplatTile& tile, const Visit& visit) {
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

SplatPass::SplatPass() : picture_(std::make_unique<Picture>()) {
    gpu::SplatTopics& topics = picture_->topics;
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

void SplatPass::Picture::make_discs(SplatDiscs& part, const SplatInput& input,
                                    std::size_t first_draw) {
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
            gpu::SplatTopics own = topics;
            std::size_t slot = run * SplatDiscs::kRun;
            const std::size_t begin = (run - first) * kBatchesPerTask;
            for (const gpu::SplatBatch& batch :
                 batches.subspan(begin, std::min(kBatchesPerTask, batches.size() - begin))) {
                for (uint i = 0; i < batch.count; ++i) {
                    const PackedSurfel& surfel = surfels[batch.first + i];
                    gpu::SplatDisc& disc = part.discs[slot];
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
            part.used[run] = static_cast<std::uint32_t>(slot - run * SplatDiscs::kRun);
        });
    }
}

SplatGroups<gpu::Floats> SplatPass::Picture::depths_of(const SplatTile& tile) const {
    SplatGroups<gpu::Floats> tile_depths{};
    for_each_pixel(tile.all(), [&](int x, int y) {
        tile_depths[tile.group(x, y)][tile.lane(x)] = depths[pixel(x, y)];
    });
    return tile_depths;
}

void SplatPass::Picture::find_nearest(const SplatTile& tile, gpu::SplatTopics& own,
                                      const SplatDiscs& part) {
    SplatGroups<gpu::Floats> nearest = depths_of(tile);
    part.for_each(part.bins.of(tile.index), [&](const gpu::SplatDisc& disc) {
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
    SplatDiscs& part = p.parts[p.used++];
    p.make_discs(part, input, first_draw);
    part.bins = part.binned(part.boxes.get(), p.topics.view);
    p.for_each_tile(
        [&](const SplatTile& tile, gpu::SplatTopics& own) { p.find_nearest(tile, own, part); });
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

void SplatPass::Picture::blend(const SplatTile& tile, gpu::SplatTopics& own,
                               SplatGroups<SplatShare>& sums) const {
    const SplatGroups<gpu::Floats> nearest = depths_of(tile);
    for (const SplatDiscs& part : std::span(parts).first(used)) {
        part.for_each(part.bins.of(tile.index), [&](const gpu::SplatDisc& disc) {
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

void SplatPass::Picture::resolve(const SplatTile& tile, gpu::SplatTopics& own,
                                 const SplatGroups<SplatShare>& sums, int x, int y,
                                 std::span<gpu::vec4> surfaces, std::span<gpu::vec4> albedos) {
    const SplatShare& sum = sums[tile.group(x, y)];
    const std::size_t i = tile.lane(x), at = pixel(x, y);
    const glm::ivec4 normal{sum.normal_x[i], sum.normal_y[i], sum.normal_z[i], sum.weight[i]};
    surfaces[at] = own.mean_surface(normal, sum.behind[i], depths[at]);
    albedos[at] =
        own.mean_albedo(normal, {sum.red[i], sum.green[i], sum.blue[i], sum.ndf_length[i]});
    weights[at] = sum.weight[i];
}

void SplatPass::blend(std::span<gpu::vec4> surfaces, std::span<gpu::vec4> albedos) {
    Picture& p = *picture_;
    p.for_each_tile([&](const SplatTile& tile, gpu::SplatTopics& own) {
        SplatGroups<SplatShare> sums{};
        p.blend(tile, own, sums);
        for_each_pixel(tile.all(),
                       [&](int x, int y) { p.resolve(tile, own, sums, x, y, surfaces, albedos); });
    });
}

}  // namespace glowworm

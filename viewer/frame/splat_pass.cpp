#include "viewer/frame/splat_pass.h"

#include <utility>

#include "viewer/frame/splat_picture.h"

namespace glowworm {
namespace {

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
    p.widths.assign(static_cast<std::size_t>(p.columns * p.rows), 0u);
    p.pyramid.reset();
    p.topics.sight = {};
    p.used = 0;
}

void SplatPass::Picture::make_discs(SplatDiscs& part, std::span<const gpu::DrawnChunk> chunks,
                                    std::span<const PagedBatch> batches) const {
    const std::size_t runs = (batches.size() + kBatchesPerTask - 1) / kBatchesPerTask;
    part.begin(runs);
    tbb::parallel_for(std::size_t{0}, runs, [&](std::size_t run) {
        gpu::SplatTopics own = topics;
        std::size_t slot = run * SplatDiscs::kRun;
        const std::size_t begin = run * kBatchesPerTask;
        for (const PagedBatch& paged :
             batches.subspan(begin, std::min(kBatchesPerTask, batches.size() - begin))) {
            const gpu::SplatBatch& batch = paged.batch;
            for (uint i = 0; i < batch.count; ++i) {
                const PackedSurfel& surfel = paged.page[batch.first + i];
                gpu::SplatDisc& disc = part.discs[slot];
                if (!own.splat_of(surfel, batch.rank + i, chunks[batch.chunk], disc.splat,
                                  disc.normal))
                    continue;
                disc.box = pixel_box(own.splat_box(disc.splat, 1.0f));
                if (disc.box.empty() && own.grown_box(disc.splat).empty()) continue;
                part.boxes[slot] = disc.box;
                disc.albedo_ndf = surfel.albedo_ndf;
                ++slot;
            }
        }
        part.used[run] = static_cast<std::uint32_t>(slot - run * SplatDiscs::kRun);
    });
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
    if (part.bins.of(tile.index).empty()) return;
    SplatGroups<gpu::Floats> nearest = depths_of(tile);
    int width = 0;
    part.for_each(part.bins.of(tile.index), [&](const gpu::SplatDisc& disc) {
        width = std::max(
            {width, disc.box.high_x - disc.box.low_x + 1, disc.box.high_y - disc.box.low_y + 1});
        for_each_hit(own, disc.splat, tile.clipped(disc.box), tile,
                     [&](std::size_t group, gpu::Floats depth, gpu::Floats off) {
                         const gpu::Floats is = nearest[group];
                         nearest[group] = (depth > 0.0f) & (off < 1.0f) & (depth < is) ? depth : is;
                     });
    });
    for_each_pixel(tile.all(), [&](int x, int y) {
        depths[pixel(x, y)] = nearest[tile.group(x, y)][tile.lane(x)];
    });
    widths[tile.index] = std::max(widths[tile.index], static_cast<uint>(width));
}

/// [rows * columns] the farthest depth in each square of DEPTH_TILE pixels, m; infinite where
/// nothing is.
std::vector<float> SplatPass::Picture::farthest_tiles() const {
    const int width = static_cast<int>(topics.view.width);
    const int height = static_cast<int>(topics.view.height);
    const int tile_columns = (width + DEPTH_TILE - 1) / DEPTH_TILE;
    const int tile_rows = (height + DEPTH_TILE - 1) / DEPTH_TILE;
    std::vector<float> farthest(static_cast<std::size_t>(tile_columns) *
                                static_cast<std::size_t>(tile_rows));
    tbb::parallel_for(0, tile_rows, [&](int row) {
        float* tiles = &farthest[static_cast<std::size_t>(row * tile_columns)];
        for (int y = row * DEPTH_TILE; y < std::min((row + 1) * DEPTH_TILE, height); ++y) {
            for (int x = 0; x < width; ++x) {
                float& tile = tiles[x / DEPTH_TILE];
                tile = std::max(tile, depths[pixel(x, y)]);
            }
        }
    });
    return farthest;
}

void SplatPass::Picture::draw(std::span<const gpu::DrawnChunk> chunks,
                              std::span<const PagedBatch> batches) {
    if (used == parts.size()) parts.emplace_back();
    SplatDiscs& part = parts[used++];
    make_discs(part, chunks, batches);
    part.bins = part.binned(part.boxes.get(), topics.view);
    for_each_tile(
        [&](const SplatTile& tile, gpu::SplatTopics& own) { find_nearest(tile, own, part); });
    look();
}

void SplatPass::Picture::look() {
    const int width = static_cast<int>(topics.view.width);
    const int height = static_cast<int>(topics.view.height);
    pyramid.emplace(farthest_tiles(), (width + DEPTH_TILE - 1) / DEPTH_TILE,
                    (height + DEPTH_TILE - 1) / DEPTH_TILE, DEPTH_TILE, widths);
    topics.sight = pyramid->finest();
}

void SplatPass::add(const SplatInput& input, std::size_t first_draw) {
    std::vector<std::span<const PackedSurfel>> pages;
    std::vector<PagedBatch> batches;
    for (const PageDraw& draw : input.draws.subspan(first_draw)) {
        pages.push_back(input.pages[draw.page].map<const PackedSurfel>());
        for (const gpu::SplatBatch& batch :
             input.batches.subspan(draw.first_batch, draw.batch_count))
            batches.push_back({batch, pages.back()});
    }
    // Chunks come the nearest first, and each page has them so.
    std::ranges::stable_sort(batches, {}, [](const PagedBatch& b) { return b.batch.chunk; });
    for (std::size_t begin = 0; begin < batches.size();) {  // each time as many again
        const std::size_t size = std::min(std::max(begin, kFirstBatches), batches.size() - begin);
        picture_->draw(input.chunks, std::span(batches).subspan(begin, size));
        begin += size;
    }
}

const DepthPyramid& SplatPass::pyramid() {
    if (!picture_->pyramid) picture_->look();
    return *picture_->pyramid;
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

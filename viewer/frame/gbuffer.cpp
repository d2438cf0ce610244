#include "viewer/frame/gbuffer.h"

#include <algorithm>
#include <utility>

#include "viewer/gpu/context.h"

namespace glowworm {
namespace {

gpu::vec4 vec4_of(const Vec3d& v, double w) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z),
            static_cast<float>(w)};
}

gpu::ViewBlock view_block_of(const View& view, const Vec3d& origin) {
    gpu::ViewBlock block{};
    block.position = vec4_of(view.position - origin, view.focal);
    block.right = vec4_of(view.right, view.orthographic ? 1.0 : 0.0);
    block.down = vec4_of(view.down, view.centre_x);
    block.forward = vec4_of(view.forward, view.centre_y);
    block.width = static_cast<std::uint32_t>(view.width);
    block.height = static_cast<std::uint32_t>(view.height);
    constexpr double kUnbounded = 1e30;
    const Vec3d everywhere{kUnbounded, kUnbounded, kUnbounded};
    block.clip_low = vec4_of(view.clip ? view.clip->low - origin : -everywhere, 0.0);
    block.clip_high = vec4_of(view.clip ? view.clip->high - origin : everywhere, 0.0);
    return block;
}

}  // namespace

GBuffer::GBuffer() : view_("view", sizeof(gpu::ViewBlock)) {}

void GBuffer::bind() const {
    view_.bind_uniform(BINDING_VIEW);
    surfaces_.bind_storage(BINDING_PIXEL_SURFACES);
    albedos_.bind_storage(BINDING_PIXEL_ALBEDOS);
}

void GBuffer::begin(const OctreeView& octree, const View& view) {
    const auto pixels =
        static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    if (surfaces_.bytes() != pixels * sizeof(gpu::vec4)) {
        surfaces_ = Buffer("pixel surfaces", pixels * sizeof(gpu::vec4));
        albedos_ = Buffer("pixel albedos", pixels * sizeof(gpu::vec4));
    }
    shown_ = view;
    view_block_ = view_block_of(view, octree.grid.origin);
    view_.write(std::span<const gpu::ViewBlock>(&view_block_, 1));
    chunks_.clear();
    batches_.clear();
    draws_.clear();
    by_shaders_ = shaders_forced_ || !runs_on_cpu();
    if (by_shaders_) {
        if (!shaders_) shaders_.emplace();
        shaders_->begin(pixels);
    } else {
        if (!pass_) pass_.emplace();
        pass_->begin(view_block_);
    }
}

void GBuffer::add(const OctreeView& octree, const SurfelCache& cloud,
                  std::span<const ChunkSelection> selection, PassTimer* timer) {
    std::vector<std::vector<gpu::SplatBatch>> of_page(cloud.pages().size());
    for (const ChunkSelection& drawn : selection) {
        const Chunk& chunk = octree.chunks[drawn.chunk];
        const auto index = static_cast<std::uint32_t>(chunks_.size());
        chunks_.push_back({{chunk.box_min[0], chunk.box_min[1], chunk.box_min[2], chunk.box_edge},
                           drawn.scale,
                           drawn.full_depth,
                           drawn.count,
                           0});
        static_assert(SurfelCache::kBlock % SPLAT_GROUP == 0);
        for (std::uint32_t first = 0; first < drawn.count; first += SPLAT_GROUP) {
            const auto place = cloud.place_of(drawn.chunk, first / SurfelCache::kBlock);
            of_page[place.page].push_back({index, place.first + first % SurfelCache::kBlock,
                                           std::min(drawn.count - first, uint{SPLAT_GROUP}),
                                           first});
        }
    }
    const std::size_t first_draw = draws_.size();
    for (std::size_t page = 0; page < of_page.size(); ++page) {
        if (of_page[page].empty()) continue;
        draws_.push_back({page, static_cast<std::uint32_t>(batches_.size()),
                          static_cast<std::uint32_t>(of_page[page].size())});
        batches_.insert(batches_.end(), of_page[page].begin(), of_page[page].end());
    }
    timed(timer, "splat depth", [&] {
        if (!by_shaders_) return pass_->add(input(cloud), first_draw);
        bind();
        shaders_->add(input(cloud), first_draw);
    });
}

DepthPyramid GBuffer::pyramid(PassTimer* timer) {
    const int columns = (shown_.width + DEPTH_TILE - 1) / DEPTH_TILE;
    const int rows = (shown_.height + DEPTH_TILE - 1) / DEPTH_TILE;
    const auto count = [](int across, int down, int edge) {
        return static_cast<std::size_t>((across + edge - 1) / edge) *
               static_cast<std::size_t>((down + edge - 1) / edge);
    };
    if (!by_shaders_) return pass_->pyramid();
    std::optional<DepthPyramid> pyramid;
    timed(timer, "depth pyramid", [&] {
        bind();
        auto [depths, widths] = shaders_->tiles(count(shown_.width, shown_.height, DEPTH_TILE),
                                                count(shown_.width, shown_.height, WIDTH_TILE));
        pyramid.emplace(std::move(depths), columns, rows, DEPTH_TILE, widths);
    });
    return *std::move(pyramid);
}

void GBuffer::finish(const SurfelCache& cloud, PassTimer* timer) {
    if (by_shaders_) {
        bind();
        timed(timer, "splat blend", [&] { shaders_->blend(input(cloud)); });
        timed(timer, "rims", [&] { shaders_->open_rims(input(cloud)); });
        timed(timer, "resolve", [&] { shaders_->resolve(); });
    } else {
        const auto surfaces = surfaces_.map<gpu::vec4>(), albedos = albedos_.map<gpu::vec4>();
        timed(timer, "splat blend", [&] { pass_->blend(surfaces, albedos); });
        timed(timer, "rims", [&] { pass_->open_rims(surfaces, albedos); });
    }
}

SplatInput GBuffer::input(const SurfelCache& cloud) const {
    return {chunks_, batches_, draws_, cloud.pages()};
}

}  // namespace glowworm

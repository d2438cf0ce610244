#include "viewer/frame/gbuffer.h"

#include <algorithm>
#include <limits>
#include <utility>

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

template <typename T>
void write_growing(Buffer& buffer, const char* label, const std::vector<T>& values) {
    const std::size_t bytes = values.size() * sizeof(T);
    if (buffer.bytes() < bytes) buffer = Buffer(label, bytes + bytes / 2);
    buffer.write(values);
}

}  // namespace

GBuffer::GBuffer() : view_("view", sizeof(gpu::ViewBlock)) {}

void GBuffer::resize(std::size_t pixels) {
    if (pixels == pixels_) return;
    pixels_ = pixels;
    depths_ = Buffer("pixel depths", pixels * sizeof(float));
    depths_.write(std::vector<float>(pixels, std::numeric_limits<float>::infinity()));
    rims_ = Buffer("pixel rims", pixels * sizeof(float));
    rim_tiles_ = Buffer("rim tiles", pixels * sizeof(std::uint32_t));  // enough for any shape
    tiles_ = Buffer("depth tiles", pixels * sizeof(float));
    normal_sums_ = Buffer("normal sums", pixels * 4 * sizeof(std::int32_t));
    albedo_sums_ = Buffer("albedo sums", pixels * 4 * sizeof(std::uint32_t));
    behind_sums_ = Buffer("behind sums", pixels * sizeof(std::int32_t));
    surfaces_ = Buffer("pixel surfaces", pixels * sizeof(gpu::vec4));
    albedos_ = Buffer("pixel albedos", pixels * sizeof(gpu::vec4));
}

void GBuffer::bind() const {
    view_.bind_uniform(BINDING_VIEW);
    surfaces_.bind_storage(BINDING_PIXEL_SURFACES);
    albedos_.bind_storage(BINDING_PIXEL_ALBEDOS);
}

void GBuffer::begin(const OctreeView& octree, const View& view) {
    resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
    shown_ = view;
    view_block_ = view_block_of(view, octree.grid.origin);
    view_.write(std::span<const gpu::ViewBlock>(&view_block_, 1));
    chunks_.clear();
    batches_.clear();
    draws_.clear();
}

void GBuffer::add(const OctreeView& octree, const SurfelCache& cloud,
                  std::span<const ChunkSelection> selection, PassTimer* timer) {
    std::vector<std::vector<gpu::SplatBatch>> of_page(cloud.pages().size());
    for (const ChunkSelection& drawn : selection) {
        const Chunk& chunk = octree.chunks[drawn.chunk];
        const auto index = static_cast<std::uint32_t>(chunks_.size());
        chunks_.push_back({{chunk.box_min[0], chunk.box_min[1], chunk.box_min[2], chunk.box_edge},
                           drawn.scale,
                           0,
                           0,
                           0});
        static_assert(SurfelCache::kBlock % SPLAT_GROUP == 0);
        for (std::uint32_t first = 0; first < drawn.count; first += SPLAT_GROUP) {
            const auto place = cloud.place_of(drawn.chunk, first / SurfelCache::kBlock);
            of_page[place.page].push_back({index, place.first + first % SurfelCache::kBlock,
                                           std::min(drawn.count - first, uint{SPLAT_GROUP}), 0});
        }
    }
    const std::size_t first_draw = draws_.size();
    for (std::size_t page = 0; page < of_page.size(); ++page) {
        if (of_page[page].empty()) continue;
        draws_.push_back({page, static_cast<std::uint32_t>(batches_.size()),
                          static_cast<std::uint32_t>(of_page[page].size())});
        batches_.insert(batches_.end(), of_page[page].begin(), of_page[page].end());
    }
    write_growing(chunk_buffer_, "drawn chunks", chunks_);
    write_growing(batch_buffer_, "splat batches", batches_);
    bind_splats();
    timed(timer, "splat depth", [&] { splat(depth_, cloud, first_draw); });
}

DepthPyramid GBuffer::pyramid(PassTimer* timer) {
    const int columns = (shown_.width + DEPTH_TILE - 1) / DEPTH_TILE;
    const int rows = (shown_.height + DEPTH_TILE - 1) / DEPTH_TILE;
    const auto count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    std::vector<float> farthest;
    timed(timer, "depth pyramid", [&] {
        bind_splats();
        depth_tiles_.dispatch(count, 64);
        farthest = tiles_.read<float>(count);
    });
    return {std::move(farthest), columns, rows, DEPTH_TILE};
}

void GBuffer::finish(const SurfelCache& cloud, PassTimer* timer) {
    bind_splats();
    timed(timer, "splat blend", [&] { splat(blend_, cloud, 0); });
    timed(timer, "rims", [&] {
        rim_tiles_.clear();
        find_rims_.dispatch(pixels_, 128);
        splat(depth_behind_, cloud, 0);
        open_rims_.dispatch(pixels_, 128);
        splat(blend_behind_, cloud, 0);
    });
    timed(timer, "resolve", [&] { resolve_.dispatch(pixels_, 128); });
}

void GBuffer::bind_splats() const {
    bind();
    chunk_buffer_.bind_storage(BINDING_DRAWN_CHUNKS);
    batch_buffer_.bind_storage(BINDING_SPLAT_BATCHES);
    depths_.bind_storage(BINDING_DEPTHS);
    tiles_.bind_storage(BINDING_DEPTH_TILES);
    rims_.bind_storage(BINDING_RIMS);
    rim_tiles_.bind_storage(BINDING_RIM_TILES);
    normal_sums_.bind_storage(BINDING_NORMAL_SUMS);
    albedo_sums_.bind_storage(BINDING_ALBEDO_SUMS);
    behind_sums_.bind_storage(BINDING_BEHIND_SUMS);
}

void GBuffer::splat(const Program& pass, const SurfelCache& cloud, std::size_t first_draw) const {
    for (std::size_t i = first_draw; i < draws_.size(); ++i) {
        const PageDraw& draw = draws_[i];
        cloud.pages()[draw.page].bind_storage(BINDING_SURFELS);
        set_uniform(pass, 0, draw.batch_count);
        set_uniform(pass, 1, draw.first_batch);
        pass.dispatch(std::size_t{draw.batch_count} * SPLAT_GROUP, SPLAT_GROUP);
    }
}

}  // namespace glowworm

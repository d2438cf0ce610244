#include "viewer/frame/gbuffer.h"

#include <limits>
#include <vector>

#include "shaders/frame_layout.h"

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

/// What one page draws: a range of the batches.
struct PageDraw {
    std::size_t page;
    std::uint32_t first_batch, batch_count;
};

struct DrawList {
    std::vector<gpu::DrawnChunk> chunks;
    std::vector<gpu::SplatBatch> batches;
    std::vector<PageDraw> pages;
};

DrawList draw_list_of(const OctreeView& octree, const SurfelPages& cloud,
                      std::span<const ChunkSelection> selection) {
    DrawList list;
    for (std::size_t page = 0; page < cloud.pages().size(); ++page) {
        const auto first_batch = static_cast<std::uint32_t>(list.batches.size());
        for (const ChunkSelection& selected : selection) {
            const SurfelPages::Place place = cloud.place_of(selected.chunk);
            if (place.page != page) continue;
            const Chunk& chunk = octree.chunks[selected.chunk];
            const auto index = static_cast<std::uint32_t>(list.chunks.size());
            list.chunks.push_back(
                {{chunk.box_min[0], chunk.box_min[1], chunk.box_min[2], chunk.box_edge},
                 place.first,
                 selected.count,
                 selected.scale,
                 0});
            for (std::uint32_t first = 0; first < selected.count; first += SPLAT_GROUP) {
                list.batches.push_back({index, first});
            }
        }
        const auto end = static_cast<std::uint32_t>(list.batches.size());
        if (end > first_batch) list.pages.push_back({page, first_batch, end - first_batch});
    }
    return list;
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

void GBuffer::draw(const OctreeView& octree, const SurfelPages& cloud,
                   std::span<const ChunkSelection> selection, const View& view, PassTimer* timer) {
    resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
    const gpu::ViewBlock block = view_block_of(view, octree.grid.origin);
    view_.write(std::span(&block, 1));
    const DrawList list = draw_list_of(octree, cloud, selection);
    write_growing(chunks_, "drawn chunks", list.chunks);
    write_growing(batches_, "splat batches", list.batches);

    bind();
    chunks_.bind_storage(BINDING_DRAWN_CHUNKS);
    batches_.bind_storage(BINDING_SPLAT_BATCHES);
    depths_.bind_storage(BINDING_DEPTHS);
    rims_.bind_storage(BINDING_RIMS);
    rim_tiles_.bind_storage(BINDING_RIM_TILES);
    normal_sums_.bind_storage(BINDING_NORMAL_SUMS);
    albedo_sums_.bind_storage(BINDING_ALBEDO_SUMS);
    behind_sums_.bind_storage(BINDING_BEHIND_SUMS);
    const auto splat = [&](const Program& pass) {
        for (const PageDraw& draw : list.pages) {
            cloud.pages()[draw.page].bind_storage(BINDING_SURFELS);
            set_uniform(pass, 0, draw.batch_count);
            set_uniform(pass, 1, draw.first_batch);
            pass.dispatch(std::size_t{draw.batch_count} * SPLAT_GROUP, SPLAT_GROUP);
        }
    };
    timed(timer, "splat depth", [&] { splat(depth_); });
    timed(timer, "splat blend", [&] { splat(blend_); });
    timed(timer, "rims", [&] {
        rim_tiles_.clear();
        find_rims_.dispatch(pixels_, 128);
        splat(depth_behind_);
        open_rims_.dispatch(pixels_, 128);
        splat(blend_behind_);
    });
    timed(timer, "resolve", [&] { resolve_.dispatch(pixels_, 128); });
}

}  // namespace glowworm

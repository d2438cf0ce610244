#include "viewer/frame/splat_shaders.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace glowworm {
namespace {

template <typename T>
void write_growing(Buffer& buffer, const char* label, std::span<const T> values) {
    const std::size_t bytes = values.size_bytes();
    if (buffer.bytes() < bytes) buffer = Buffer(label, bytes + bytes / 2);
    buffer.write(values);
}

}  // namespace

void SplatShaders::begin(std::size_t pixels) {
    if (pixels == pixels_) return tiles_.clear();
    pixels_ = pixels;
    depths_ = Buffer("pixel depths", pixels * sizeof(float));
    depths_.write(std::vector<float>(pixels, std::numeric_limits<float>::infinity()));
    rims_ = Buffer("pixel rims", pixels * sizeof(float));
    rim_tiles_ = Buffer("rim tiles", pixels * sizeof(std::uint32_t));  // enough for any shape
    tiles_ = Buffer("depth tiles", 2 * pixels * sizeof(float));        // enough for any shape
    tiles_.clear();
    normal_sums_ = Buffer("normal sums", pixels * 4 * sizeof(std::int32_t));
    albedo_sums_ = Buffer("albedo sums", pixels * 4 * sizeof(std::int32_t));
    behind_sums_ = Buffer("behind sums", pixels * sizeof(std::int32_t));
}

void SplatShaders::bind() const {
    chunks_.bind_storage(BINDING_DRAWN_CHUNKS);
    batches_.bind_storage(BINDING_SPLAT_BATCHES);
    depths_.bind_storage(BINDING_DEPTHS);
    tiles_.bind_storage(BINDING_DEPTH_TILES);
    rims_.bind_storage(BINDING_RIMS);
    rim_tiles_.bind_storage(BINDING_RIM_TILES);
    normal_sums_.bind_storage(BINDING_NORMAL_SUMS);
    albedo_sums_.bind_storage(BINDING_ALBEDO_SUMS);
    behind_sums_.bind_storage(BINDING_BEHIND_SUMS);
}

void SplatShaders::splat(const Program& pass, const SplatInput& input,
                         std::size_t first_draw) const {
    for (const PageDraw& draw : input.draws.subspan(first_draw)) {
        input.pages[draw.page].bind_storage(BINDING_SURFELS);
        set_uniform(pass, 0, draw.batch_count);
        set_uniform(pass, 1, draw.first_batch);
        pass.dispatch(std::size_t{draw.batch_count} * SPLAT_GROUP, SPLAT_GROUP);
    }
}

void SplatShaders::add(const SplatInput& input, std::size_t first_draw) {
    write_growing(chunks_, "drawn chunks", input.chunks);
    write_growing(batches_, "splat batches", input.batches);
    bind();
    splat(depth_, input, first_draw);
}

std::pair<std::vector<float>, std::vector<std::uint32_t>> SplatShaders::tiles(
    std::size_t depth_tiles, std::size_t width_tiles) {
    bind();
    depth_tiles_.dispatch(depth_tiles, 64);
    std::vector<std::uint32_t> bits = tiles_.read<std::uint32_t>(depth_tiles + width_tiles);
    std::vector<float> depths(depth_tiles);
    std::transform(bits.begin(), bits.begin() + static_cast<std::ptrdiff_t>(depth_tiles),
                   depths.begin(), [](std::uint32_t b) { return std::bit_cast<float>(b); });
    bits.erase(bits.begin(), bits.begin() + static_cast<std::ptrdiff_t>(depth_tiles));
    return {std::move(depths), std::move(bits)};
}

void SplatShaders::blend(const SplatInput& input) {
    bind();
    splat(blend_, input, 0);
}

void SplatShaders::open_rims(const SplatInput& input) {
    rim_tiles_.clear();
    bind();
    find_rims_.dispatch(pixels_, 128);
    splat(depth_behind_, input, 0);
    open_rims_.dispatch(pixels_, 128);
    splat(blend_behind_, input, 0);
}

void SplatShaders::resolve() {
    bind();
    resolve_.dispatch(pixels_, 128);
}

}  // namespace glowworm

#include "viewer/frame/display.h"

#include <algorithm>
#include <cmath>

#include "shaders/frame_layout.h"

namespace glowworm {
namespace {

constexpr int kStripPixels = 1 << 20;  // what is tone-mapped at once

}  // namespace

void Display::draw(const Buffer& beauty, const Texture& target, double stops, ToneCurve curve) {
    beauty.bind_storage(BINDING_PIXEL_BEAUTY);
    target.bind_image(0, GL_WRITE_ONLY);
    set_uniform(tonemap_, 0, static_cast<float>(stops));
    set_uniform(tonemap_, 1, static_cast<std::uint32_t>(curve));
    tonemap_.use();
    glDispatchCompute(static_cast<GLuint>(target.width() + 7) / 8,
                      static_cast<GLuint>(target.height() + 7) / 8, 1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

Picture Display::picture_of(const FrameLayers& layers, double stops, ToneCurve curve) {
    Picture picture{layers.width, layers.height, {}};
    picture.rgb.reserve(layers.depth.size() * 3);
    const int strip_rows = std::max(1, kStripPixels / std::max(1, layers.width));
    for (int row = 0; row < layers.height; row += strip_rows) {
        const int rows = std::min(strip_rows, layers.height - row);
        const std::size_t width = static_cast<std::size_t>(layers.width);
        const std::size_t first = static_cast<std::size_t>(row) * width;
        std::vector<gpu::vec4> beauty(static_cast<std::size_t>(rows) * width);
        for (std::size_t i = 0; i < beauty.size(); ++i) {
            const Vec3f color = layers.beauty(first + i);
            beauty[i] = {color.x, color.y, color.z, 1.0f};
        }
        const Buffer strip = Buffer::of("strip", std::span<const gpu::vec4>(beauty));
        const Texture shown("shown strip", GL_RGBA8, layers.width, rows);
        draw(strip, shown, stops, curve);
        const std::vector<float> texels = shown.read_floats(GL_RGBA, 4);
        for (std::size_t i = 0; i < texels.size(); ++i) {
            if (i % 4 == 3) continue;
            picture.rgb.push_back(static_cast<unsigned char>(std::lround(texels[i] * 255.0f)));
        }
    }
    return picture;
}

std::vector<float> Display::luminances(const Buffer& beauty, int width, int height) {
    const int columns = width / LUMINANCE_STRIDE, rows = height / LUMINANCE_STRIDE;
    const std::size_t count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    if (count == 0) return {};
    if (luminances_.bytes() < count * sizeof(float)) {
        luminances_ = Buffer("luminances", count * sizeof(float));
    }
    beauty.bind_storage(BINDING_PIXEL_BEAUTY);
    luminances_.bind_storage(BINDING_LUMINANCES);
    set_uniform(luminance_, 0, static_cast<std::uint32_t>(width));
    set_uniform(luminance_, 1, static_cast<std::uint32_t>(count));
    luminance_.dispatch(count, 64);
    return luminances_.read<float>(count);
}

}  // namespace glowworm

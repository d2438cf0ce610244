#include "viewer/app/sharpening.h"

#include <algorithm>
#include <cmath>

namespace glowworm {
namespace {

Framebuffer framebuffer_of(const Texture& texture, const char* label) {
    const Texture* const colors[] = {&texture};
    return Framebuffer(label, colors, nullptr);
}

std::vector<WindowTile> tiles_from_the_middle(int width, int height, int edge) {
    std::vector<WindowTile> tiles;
    for (int y = 0; y < height; y += edge) {
        for (int x = 0; x < width; x += edge)
            tiles.push_back({x, y});
    }
    const auto off_middle = [&](const WindowTile& tile) {
        return std::hypot(tile.x + (edge - width) / 2, tile.y + (edge - height) / 2);
    };
    std::ranges::stable_sort(tiles, {}, off_middle);
    return tiles;
}

}  // namespace

void Sharpening::begin(const Framebuffer& coarse, int coarse_width, int coarse_height, int width,
                       int height) {
    if (picture_.width() != width || picture_.height() != height) {
        picture_ = Texture("sharp picture", GL_RGBA8, width, height);
        picture_framebuffer_ = framebuffer_of(picture_, "sharp picture");
    }
    glBlitNamedFramebuffer(coarse.name(), picture_framebuffer_.name(), 0, 0, coarse_width,
                           coarse_height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_LINEAR);
    tiles_ = tiles_from_the_middle(width, height, kTileEdge);
    next_ = 0;
    active_ = true;
}

double Sharpening::share_done() const {
    return tiles_.empty() ? 1.0 : static_cast<double>(next_) / static_cast<double>(tiles_.size());
}

const Texture& Sharpening::target() {
    if (tile_.width() == 0) {
        tile_ = Texture("tile", GL_RGBA8, kTileEdge, kTileEdge);
        tile_framebuffer_ = framebuffer_of(tile_, "tile");
    }
    return tile_;
}

void Sharpening::put() {
    const auto [x, y] = tiles_[next_++];
    const int width = std::min(kTileEdge, picture_.width() - x);
    const int height = std::min(kTileEdge, picture_.height() - y);
    glBlitNamedFramebuffer(tile_framebuffer_.name(), picture_framebuffer_.name(), 0, 0, width,
                           height, x, y, x + width, y + height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void Sharpening::present() const {
    const int width = picture_.width(), height = picture_.height();
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, width, height);
    // The picture's first row is the top one, GL's the bottom one.
    glBlitNamedFramebuffer(picture_framebuffer_.name(), 0, 0, 0, width, height, 0, height, width, 0,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace glowworm

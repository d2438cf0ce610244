#include "viewer/app/canvas.h"

namespace glowworm {

const Texture& Canvas::target(int width, int height) {
    if (texture_.width() != width || texture_.height() != height) {
        texture_ = Texture("canvas", GL_RGBA8, width, height);
        const Texture* const colors[] = {&texture_};
        framebuffer_ = Framebuffer("canvas", colors, nullptr);
    }
    return texture_;
}

void Canvas::present(int window_width, int window_height) const {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, window_width, window_height);
    // The frame's first row is the top one, GL's the bottom one.
    glBlitNamedFramebuffer(framebuffer_.name(), 0, 0, 0, texture_.width(), texture_.height(), 0,
                           window_height, window_width, 0, GL_COLOR_BUFFER_BIT, GL_LINEAR);
}

}  // namespace glowworm

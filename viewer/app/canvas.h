#pragma once

#include "viewer/frame/display.h"

namespace glowworm {

/// A picture between the frame and the window: as fine as there was time for, then stretched.
class Canvas {
  public:
    /// Somewhere to draw a frame of `width` x `height` pixels.
    const Texture& target(int width, int height);
    bool empty() const { return texture_.width() == 0; }
    /// Copies it over the window's framebuffer of that size.
    void present(int window_width, int window_height) const;
    const Framebuffer& framebuffer() const { return framebuffer_; }

  private:
    Texture texture_;
    Framebuffer framebuffer_;
};

}  // namespace glowworm

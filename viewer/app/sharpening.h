#pragma once

#include <vector>

#include "viewer/gpu/objects.h"

namespace glowworm {

/// A square of the window, pixels from its upper left corner.
struct WindowTile {
    int x, y;
};

/// A window's picture at rest, made sharp tile by tile: where a machine cannot draw all pixels in
/// the time of a frame, it draws some of them each frame, from the middle outward.
class Sharpening {
  public:
    static constexpr int kTileEdge = 96;  ///< pixels

    /// Starts from a coarser picture, stretched to the window's `width` x `height` pixels.
    void begin(const Framebuffer& coarse, int coarse_width, int coarse_height, int width,
               int height);
    void stop() { active_ = false; }

    bool active() const { return active_; }
    bool done() const { return next_ == tiles_.size(); }
    double share_done() const;  ///< 0..1

    /// The tile to draw next; only where not done.
    WindowTile tile() const { return tiles_[next_]; }
    /// Somewhere to draw it, kTileEdge square. What lies outside the window is left out.
    const Texture& target();
    /// The tile lies in the target.
    void put();
    /// Copies the picture over the window's framebuffer.
    void present() const;

  private:
    bool active_ = false;
    std::vector<WindowTile> tiles_;
    std::size_t next_ = 0;
    Texture picture_, tile_;
    Framebuffer picture_framebuffer_, tile_framebuffer_;
};

}  // namespace glowworm

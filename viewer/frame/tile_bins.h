#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace glowworm {

/// A rectangle of pixels, both ends included; none where the highest lies below the lowest.
struct PixelBox {
    std::int16_t low_x, low_y, high_x, high_y;

    bool empty() const { return low_x > high_x || low_y > high_y; }
};

/// Which of many boxes touch each square of a picture, so that squares can be drawn side by side.
class TileBins {
  public:
    static constexpr int kTile = 32;  ///< pixels along a square's edge

    TileBins() = default;
    /// `boxes`: within a picture of `width` x `height` pixels, in runs of `run`; of each the first
    /// `used` count. The same on any number of threads.
    TileBins(std::span<const PixelBox> boxes, std::size_t run, std::span<const std::uint32_t> used,
             int width, int height);

    /// Indices of the boxes that touch a square, ascending; squares go row by row.
    std::span<const std::uint32_t> of(std::size_t tile) const {
        return std::span(items_).subspan(first_[tile], first_[tile + 1] - first_[tile]);
    }

  private:
    std::vector<std::size_t> first_;  // [tiles + 1]
    std::vector<std::uint32_t> items_;
};

}  // namespace glowworm

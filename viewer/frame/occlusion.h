#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "viewer/frame/chunk_boxes.h"
#include "viewer/frame/view.h"

namespace glowworm {

/// How far one sees in every square of a frame and round it, and in every coarser square over four
/// of them. Round it: where only the outer parts of discs reach, what lies behind shows at last,
/// and as far from there as discs are wide it shows by itself.
class DepthPyramid {
  public:
    /// `tiles`: [rows * columns] m along the view axis, the farthest pixel of each square of
    /// `tile_edge` pixels; infinite where one sees nothing. `widths`: pixels that the widest disc
    /// spans which touches a square of kWidthTiles by kWidthTiles of these, row by row; where there
    /// are none, no more than `tile_edge`.
    DepthPyramid(std::vector<float> tiles, int columns, int rows, int tile_edge,
                 std::span<const std::uint32_t> widths = {});
    static constexpr int kWidthTiles = 4;

    /// The farthest depth in a rectangle of pixels, both ends included, and round it. What lies
    /// outside the frame does not count; infinite where all of it does.
    float farthest(double low_x, double low_y, double high_x, double high_y) const;
    /// [rows * columns] The farthest depth in each of the finest squares and round it.
    std::span<const float> finest() const { return levels_.front().farthest; }

  private:
    struct Level {
        int columns, rows;
        std::vector<float> farthest;
    };
    void coarsen();
    float farthest_of_tiles(int left, int top, int right, int bottom) const;

    int tile_edge_;
    std::vector<Level> levels_;  ///< the finest first
};

/// Whether nothing of what lies in `box` can be seen past what `pyramid` shows of `view`. Its discs
/// are of `radius` m at most. What lies so near behind the visible surface that it may be a part of
/// it is not hidden. `origin` is the octree's, m, world.
bool is_hidden(const DepthPyramid& pyramid, const View& view, const Vec3d& origin,
               const ChunkBox& box, double radius);

}  // namespace glowworm

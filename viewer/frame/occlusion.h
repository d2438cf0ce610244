#pragma once

#include <vector>

#include "viewer/frame/chunk_boxes.h"
#include "viewer/frame/view.h"

namespace glowworm {

/// How far one sees in every square of a frame, and in every coarser square over four of them.
class DepthPyramid {
  public:
    /// `tiles`: [rows * columns] m along the view axis, the farthest pixel of each square of
    /// `tile_edge` pixels; infinite where one sees nothing.
    DepthPyramid(std::vector<float> tiles, int columns, int rows, int tile_edge);

    /// The farthest depth in a rectangle of pixels, both ends included, and in the squares round
    /// it. What lies outside the frame does not count; infinite where all of it does.
    float farthest(double low_x, double low_y, double high_x, double high_y) const;

  private:
    struct Level {
        int columns, rows;
        std::vector<float> farthest;
    };
    int tile_edge_;
    std::vector<Level> levels_;  ///< the finest first
};

/// Whether nothing of what lies in `box` can be seen past what `pyramid` shows of `view`. Its discs
/// are of `radius` m at most. What lies so near behind the visible surface that it may be a part of
/// it is not hidden. `origin` is the octree's, m, world.
bool is_hidden(const DepthPyramid& pyramid, const View& view, const Vec3d& origin,
               const ChunkBox& box, double radius);

}  // namespace glowworm

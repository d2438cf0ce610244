#include "viewer/frame/occlusion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace glowworm {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();
constexpr int kMostSquares = 4;           // along each axis that a query reads
constexpr double kSmallestRadius = 0.75;  // pixels; that of splat.glsl
constexpr double kTooNear = 1e-3;         // m: behind the eye, or so near that it fills the picture

}  // namespace

DepthPyramid::DepthPyramid(std::vector<float> tiles, int columns, int rows, int tile_edge,
                           std::span<const std::uint32_t> widths)
    : tile_edge_(tile_edge) {
    levels_.push_back({columns, rows, std::move(tiles)});
    coarsen();
    Level round{columns, rows, {}};
    round.farthest.reserve(levels_.front().farthest.size());
    const int width_columns = (columns + kWidthTiles - 1) / kWidthTiles;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const int square = y / kWidthTiles * width_columns + x / kWidthTiles;
            const int width =
                widths.empty() ? 0 : static_cast<int>(widths[static_cast<std::size_t>(square)]);
            const int reach = std::max((width + tile_edge - 1) / tile_edge, 1);
            round.farthest.push_back(
                farthest_of_tiles(std::max(x - reach, 0), std::max(y - reach, 0),
                                  std::min(x + reach, columns - 1), std::min(y + reach, rows - 1)));
        }
    }
    levels_.assign(1, std::move(round));
    coarsen();
}

void DepthPyramid::coarsen() {
    while (levels_.back().columns > 1 || levels_.back().rows > 1) {
        const Level& fine = levels_.back();
        Level coarse{(fine.columns + 1) / 2, (fine.rows + 1) / 2, {}};
        coarse.farthest.resize(static_cast<std::size_t>(coarse.columns * coarse.rows), 0.0f);
        for (int y = 0; y < fine.rows; ++y) {
            for (int x = 0; x < fine.columns; ++x) {
                float& square =
                    coarse.farthest[static_cast<std::size_t>(y / 2 * coarse.columns + x / 2)];
                square =
                    std::max(square, fine.farthest[static_cast<std::size_t>(y * fine.columns + x)]);
            }
        }
        levels_.push_back(std::move(coarse));
    }
}

float DepthPyramid::farthest(double low_x, double low_y, double high_x, double high_y) const {
    const Level& finest = levels_.front();
    const auto tile = [&](double pixel, int count) {
        return static_cast<int>(std::clamp(std::floor(pixel / tile_edge_), -2.0, count + 1.0));
    };
    const int left = tile(low_x, finest.columns), right = tile(high_x, finest.columns);
    const int top = tile(low_y, finest.rows), bottom = tile(high_y, finest.rows);
    if (right < 0 || bottom < 0 || left >= finest.columns || top >= finest.rows) return kNothing;
    return farthest_of_tiles(std::max(left, 0), std::max(top, 0),
                             std::min(right, finest.columns - 1),
                             std::min(bottom, finest.rows - 1));
}

/// Both ends included. Of a large rectangle, in coarser squares that hold it.
float DepthPyramid::farthest_of_tiles(int left, int top, int right, int bottom) const {
    std::size_t level = 0;
    while (level + 1 < levels_.size() &&
           (right - left >= kMostSquares || bottom - top >= kMostSquares)) {
        left /= 2;
        right /= 2;
        top /= 2;
        bottom /= 2;
        ++level;
    }
    float farthest = 0.0f;
    for (int y = top; y <= bottom; ++y) {
        for (int x = left; x <= right; ++x) {
            const std::size_t square = static_cast<std::size_t>(y * levels_[level].columns + x);
            farthest = std::max(farthest, levels_[level].farthest[square]);
        }
    }
    return farthest;
}

bool is_hidden(const DepthPyramid& pyramid, const View& view, const Vec3d& origin,
               const ChunkBox& box, double radius) {
    const Vec3d centre = origin + box.centre;
    // Discs stick out of the box; far ones are drawn as large as a pixel.
    const double farthest = dot(centre - view.position, view.forward) + length(box.half);
    const double pixel = (view.orthographic ? 1.0 : farthest) / view.focal;
    const double reach = std::max(radius, kSmallestRadius * pixel);
    const Vec3d half = box.half + Vec3d{reach, reach, reach};
    double low_x = kNothing, low_y = kNothing, high_x = -low_x, high_y = -low_y;
    double nearest = kNothing;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d offset{corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
                           corner & 4 ? half.z : -half.z};
        const PixelPoint at = project(view, centre + offset);
        if (at.depth < kTooNear) return false;
        low_x = std::min(low_x, at.x);
        low_y = std::min(low_y, at.y);
        high_x = std::max(high_x, at.x);
        high_y = std::max(high_y, at.y);
        nearest = std::min(nearest, at.depth);
    }
    return static_cast<double>(pyramid.farthest(low_x, low_y, high_x, high_y)) + reach < nearest;
}

}  // namespace glowworm

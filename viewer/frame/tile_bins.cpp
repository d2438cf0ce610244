#include "viewer/frame/tile_bins.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace glowworm {
namespace {

constexpr std::size_t kMostBlocks = 64;

template <typename Visit>
void for_each_tile(const PixelBox& box, int columns, const Visit& visit) {
    if (box.empty()) return;
    constexpr int kTile = TileBins::kTile;
    for (int y = box.low_y / kTile; y <= box.high_y / kTile; ++y) {
        for (int x = box.low_x / kTile; x <= box.high_x / kTile; ++x)
            visit(static_cast<std::size_t>(y * columns + x));
    }
}

}  // namespace

TileBins::TileBins(std::span<const PixelBox> boxes, std::size_t run,
                   std::span<const std::uint32_t> used, int width, int height) {
    const int columns = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile;
    const auto tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    const std::size_t block = (used.size() + kMostBlocks - 1) / kMostBlocks;  // runs
    const std::size_t blocks = used.empty() ? 0 : (used.size() + block - 1) / block;
    const auto for_each_box = [&](std::size_t b, const auto& visit) {
        for (std::size_t r = b * block; r < std::min((b + 1) * block, used.size()); ++r) {
            for (std::size_t i = r * run; i < r * run + used[r]; ++i)
                visit(i);
        }
    };

    // A counting sort: where each block's part of each square begins, then the parts.
    std::vector<std::uint32_t> counts(blocks * tiles);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        const std::span mine = std::span(counts).subspan(b * tiles, tiles);
        for_each_box(b, [&](std::size_t i) {
            for_each_tile(boxes[i], columns, [&](std::size_t tile) { ++mine[tile]; });
        });
    });
    first_.resize(tiles + 1);
    std::vector<std::size_t> places(blocks * tiles);
    std::size_t total = 0;
    for (std::size_t tile = 0; tile < tiles; ++tile) {
        first_[tile] = total;
        for (std::size_t b = 0; b < blocks; ++b) {
            places[b * tiles + tile] = total;
            total += counts[b * tiles + tile];
        }
    }
    first_[tiles] = total;
    items_.resize(total);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        const std::span mine = std::span(places).subspan(b * tiles, tiles);
        for_each_box(b, [&](std::size_t i) {
            for_each_tile(boxes[i], columns, [&](std::size_t tile) {
                items_[mine[tile]++] = static_cast<std::uint32_t>(i);
            });
        });
    });
}

}  // namespace glowworm

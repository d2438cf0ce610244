#include "preprocess/command/level_plot.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <string>

namespace glowworm {
namespace {

constexpr Rgb8 kInk{40, 40, 46}, kFrame{205, 205, 212}, kPaper{255, 255, 255};
constexpr Rgb8 kBars[3] = {{64, 105, 160}, {52, 140, 115}, {185, 120, 60}};

// Pixels.
constexpr int kRow = 76, kBarHeight = 60, kHead = 44, kLabel = 180;
constexpr int kPanel = 260, kBetween = 24;

/// Bars of a histogram on a line, `x` and `y` its upper left corner.
void draw_bars(Picture& picture, int x, int y, std::span<const std::uint64_t> counts, Rgb8 colour) {
    const std::uint64_t most = std::max<std::uint64_t>(1, *std::ranges::max_element(counts));
    picture.fill(x, y + kBarHeight, kPanel, 1, kFrame);
    const int step = kPanel / static_cast<int>(counts.size());
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] == 0) continue;
        const double part = static_cast<double>(counts[i]) / static_cast<double>(most);
        const int high = std::max(1, static_cast<int>(std::lround(part * kBarHeight)));
        picture.fill(x + static_cast<int>(i) * step, y + kBarHeight - high, step - 1, high, colour);
    }
}

template <std::size_t bins>
void count_unit(float value, std::array<std::uint64_t, bins>& counts) {
    const float at = std::clamp(value, 0.0f, 1.0f) * bins;
    ++counts[std::isnan(at) ? 0 : std::min(bins - 1, static_cast<std::size_t>(at))];
}

}  // namespace

std::vector<LevelHistograms> measure_levels(const OctreeView& octree) {
    std::vector<LevelHistograms> levels;
    for (const Level& level : octree.levels) {
        LevelHistograms& out = levels.emplace_back();
        out.nodes = level.node_count;
        for (std::size_t i = level.first_node; i < level.first_node + level.node_count; ++i) {
            const NodeAttributes& a = octree.attributes[i];
            const std::uint32_t mask = octree.nodes[i].mask;
            const bool leaf = levels.size() == octree.levels.size();
            const std::uint32_t children =
                leaf ? mask >> 8 & 3u : static_cast<std::uint32_t>(std::popcount(mask & 0xffu));
            count_unit(a.opacity, out.opacity);
            count_unit(std::hypot(a.ndf[0], a.ndf[1], a.ndf[2]), out.ndf_length);
            if (children > 0) ++out.children[children - 1];
        }
    }
    return levels;
}

Picture plot_levels(const std::vector<LevelHistograms>& levels) {
    const auto panel = [](int i) { return kLabel + i * (kPanel + kBetween); };
    Picture picture(panel(3), 2 * kHead + static_cast<int>(levels.size()) * kRow, kPaper);
    picture.write("level, nodes", 12, 12, kInk);
    picture.write("opacity, 0 to 1", panel(0), 12, kInk);
    picture.write("NDF length, 0 to 1", panel(1), 12, kInk);
    picture.write("children, 1 to 8", panel(2), 12, kInk);
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const int y = kHead + static_cast<int>(i) * kRow;
        picture.write(std::to_string(i), 12, y + 12, kInk);
        picture.write(std::to_string(levels[i].nodes), 12, y + 12 + kLineHeight, kInk);
        draw_bars(picture, panel(0), y, levels[i].opacity, kBars[0]);
        draw_bars(picture, panel(1), y, levels[i].ndf_length, kBars[1]);
        draw_bars(picture, panel(2), y, levels[i].children, kBars[2]);
    }
    return picture;
}

}  // namespace glowworm

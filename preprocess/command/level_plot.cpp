#include "preprocess/command/level_plot.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <string>

#include "preprocess/command/command.h"

namespace glowworm {
namespace {

constexpr Rgb8 kInk{40, 40, 46}, kFaint{120, 120, 130}, kFrame{205, 205, 212},
    kPaper{255, 255, 255};
constexpr Rgb8 kBars[3] = {{64, 105, 160}, {52, 140, 115}, {185, 120, 60}};

// Pixels.
constexpr int kBarHeight = 60, kRow = kBarHeight + 3 * kLineHeight, kHead = 3 * kLineHeight;
constexpr int kLabel = 210, kPanel = 300, kBetween = 36, kMargin = 12;

/// What lies below a panel: a word under the left end, the middle and the right end of its bars.
struct Axis {
    std::string left, middle, right;
};

/// Bars of a histogram over its axis, `x` and `y` the upper left corner; above them how many the
/// highest stands for.
void draw_panel(Picture& picture, int x, int y, std::span<const std::uint64_t> counts, Rgb8 colour,
                const Axis& axis) {
    const std::uint64_t most = std::max<std::uint64_t>(1, *std::ranges::max_element(counts));
    const int step = kPanel / static_cast<int>(counts.size());
    const int width = step * static_cast<int>(counts.size());
    picture.write(format_count(most), x, y, kFaint);
    const int base = y + kLineHeight + kBarHeight;
    picture.fill(x, base, width, 2, kFrame);
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] == 0) continue;
        const double part = static_cast<double>(counts[i]) / static_cast<double>(most);
        const int high = std::max(1, static_cast<int>(std::lround(part * kBarHeight)));
        picture.fill(x + static_cast<int>(i) * step, base - high, step - 1, high, colour);
    }
    const int below = base + 6;
    picture.write(axis.left, x, below, kFaint);
    picture.write(axis.middle, x + (width - written_width(axis.middle)) / 2, below, kFaint);
    picture.write(axis.right, x + width - written_width(axis.right), below, kFaint);
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
    Picture picture(panel(3), kHead + static_cast<int>(levels.size()) * kRow, kPaper);
    picture.write("How many nodes of each level have which", kMargin, kMargin, kInk);
    const int titles = kMargin + kLineHeight;
    picture.write("opacity", panel(0), titles, kBars[0]);
    picture.write("NDF length", panel(1), titles, kBars[1]);
    picture.write("number of children", panel(2), titles, kBars[2]);
    const Axis unit{"0", "0.5", "1"};
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const LevelHistograms& level = levels[i];
        const bool leaves = i + 1 == levels.size();
        const int y = kHead + static_cast<int>(i) * kRow;
        const int middle = y + kLineHeight;
        picture.write("level " + std::to_string(i), kMargin, middle, kInk);
        picture.write(format_count(level.nodes) + (leaves ? " leaves" : ""), kMargin,
                      middle + kLineHeight, kInk);
        draw_panel(picture, panel(0), y, level.opacity, kBars[0], unit);
        draw_panel(picture, panel(1), y, level.ndf_length, kBars[1], unit);
        const std::span<const std::uint64_t> children = level.children;
        if (leaves) {
            draw_panel(picture, panel(2), y, children.first(3), kBars[2],
                       {"1 lobe", "2", "3 lobes"});
        } else {
            draw_panel(picture, panel(2), y, children, kBars[2], {"1 child", "", "8 children"});
        }
    }
    return picture;
}

}  // namespace glowworm

#include "preprocess/command/level_plot.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

namespace glowworm {
namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr Colour kInk{40, 40, 46}, kFrame{205, 205, 212};
constexpr Colour kBars[3] = {{64, 105, 160}, {52, 140, 115}, {185, 120, 60}};

// Pixels.
constexpr int kRow = 76, kBarHeight = 60, kHead = 34, kLabel = 150;
constexpr int kPanel = 260, kBetween = 24, kLetter = 2;

/// Letters of 3 x 5 pixels, rows from the top, three bits each.
int letter_bits(char letter) {
    constexpr std::string_view kLetters = "0123456789ACDEFGHILNOPRSTVY-.";
    constexpr int kBits[] = {075557, 026227, 071747, 071717, 055711, 074717, 074757, 071111,
                             075757, 075717, 025755, 034443, 065556, 074647, 074644, 034553,
                             055755, 072227, 044447, 065555, 075557, 065644, 065655, 034216,
                             072222, 055552, 055222, 000700, 000002};
    const auto at = kLetters.find(letter);
    return at == std::string_view::npos ? 0 : kBits[at];
}

class Canvas {
  public:
    Canvas(int width, int height)
        : picture_{width, height, std::vector<std::uint8_t>(std::size_t(width) * height * 3, 255)} {
    }

    void fill(int x, int y, int width, int height, const Colour& colour) {
        for (int row = std::max(y, 0); row < std::min(y + height, picture_.height); ++row) {
            for (int column = std::max(x, 0); column < std::min(x + width, picture_.width);
                 ++column) {
                const std::size_t at = (std::size_t(row) * picture_.width + column) * 3;
                std::ranges::copy(colour, picture_.pixels.begin() + std::ptrdiff_t(at));
            }
        }
    }

    void write(int x, int y, std::string_view text) {
        for (const char letter : text) {
            const int bits = letter_bits(letter);
            for (int pixel = 0; pixel < 15; ++pixel) {
                if (bits >> (14 - pixel) & 1) {
                    fill(x + pixel % 3 * kLetter, y + pixel / 3 * kLetter, kLetter, kLetter, kInk);
                }
            }
            x += 4 * kLetter;
        }
    }

    /// Bars of a histogram on a frame, `x` and `y` its upper left corner.
    void draw(int x, int y, std::span<const std::uint64_t> counts, const Colour& colour) {
        const std::uint64_t most = std::max<std::uint64_t>(1, *std::ranges::max_element(counts));
        fill(x, y + kBarHeight, kPanel, 1, kFrame);
        const int step = kPanel / static_cast<int>(counts.size());
        for (std::size_t i = 0; i < counts.size(); ++i) {
            if (counts[i] == 0) continue;
            const double part = static_cast<double>(counts[i]) / static_cast<double>(most);
            const int high = std::max(1, static_cast<int>(std::lround(part * kBarHeight)));
            fill(x + static_cast<int>(i) * step, y + kBarHeight - high, step - 1, high, colour);
        }
    }

    PlanView take() { return std::move(picture_); }

  private:
    PlanView picture_;
};

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

PlanView plot_levels(const std::vector<LevelHistograms>& levels) {
    const auto panel = [](int i) { return kLabel + i * (kPanel + kBetween); };
    Canvas canvas(panel(3), kHead + static_cast<int>(levels.size()) * kRow + kHead);
    canvas.write(12, 12, "LEVEL");
    canvas.write(panel(0), 12, "OPACITY 0-1");
    canvas.write(panel(1), 12, "NDF LENGTH 0-1");
    canvas.write(panel(2), 12, "CHILDREN 1-8");
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const int y = kHead + static_cast<int>(i) * kRow;
        canvas.write(12, y + 16, std::to_string(i));
        canvas.write(12, y + 36, std::to_string(levels[i].nodes));
        canvas.draw(panel(0), y, levels[i].opacity, kBars[0]);
        canvas.draw(panel(1), y, levels[i].ndf_length, kBars[1]);
        canvas.draw(panel(2), y, levels[i].children, kBars[2]);
    }
    return canvas.take();
}

}  // namespace glowworm

#include "preprocess/plot/lettering.h"

#include <algorithm>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

namespace glowworm {
namespace {

constexpr std::size_t kBytesPerCharacter = 512;  // stb_easy_font asks for about 270
constexpr int kDotsHigh = 10;

/// One line of printable ASCII: the font knows nothing else.
std::vector<char> printable(const std::string& text) {
    std::vector<char> line(text.begin(), text.end());
    for (char& c : line) {
        if (c < ' ' || c > '~') c = '?';
    }
    line.push_back('\0');
    return line;
}

}  // namespace

int text_width(const std::string& text, int scale) {
    return scale * stb_easy_font_width(printable(text).data());
}

int text_height(int scale) {
    return scale * kDotsHigh;
}

void draw_text(const std::string& text, int x, int y, int scale,
               const std::function<void(int, int)>& dot) {
    struct Corner {
        float x, y, z;
        unsigned char colour[4];
    };
    std::vector<Corner> corners(text.size() * kBytesPerCharacter / sizeof(Corner) + 4);
    const int quads =
        stb_easy_font_print(0.0f, 0.0f, printable(text).data(), nullptr, corners.data(),
                            static_cast<int>(corners.size() * sizeof(Corner)));
    for (int q = 0; q < quads; ++q) {
        const Corner* quad = &corners[static_cast<std::size_t>(q) * 4];  // clockwise, upright
        const auto dots = [&](float value) { return static_cast<int>(value) * scale; };
        for (int v = dots(quad[0].y); v < dots(quad[2].y); ++v) {
            for (int u = dots(quad[0].x); u < dots(quad[2].x); ++u)
                dot(x + u, y + v);
        }
    }
}

}  // namespace glowworm

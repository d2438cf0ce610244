#include "preprocess/plot/map_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "preprocess/plot/lettering.h"

namespace glowworm {
namespace {

constexpr int kBarThickness = 3;  // pixels
constexpr int kHeadLength = 16;
constexpr int kHeadHalfWidth = 8;

int above(int bottom) {
    return bottom - text_height(kLetterScale) - 2;
}

}  // namespace

double round_length(double length) {
    const double power = std::pow(10.0, std::floor(std::log10(length)));
    for (const double step : {5.0, 2.0}) {
        if (step * power <= length) return step * power;
    }
    return power;
}

void draw_scale_bar(Picture& picture, int x, int bottom, int longest, double scale, Rgb8 colour) {
    const double length = round_length(longest / scale);
    picture.fill(x, bottom, static_cast<int>(scale * length), kBarThickness, colour);
    picture.write(fmt::format("{:g} m", length), x, above(bottom), colour);
}

void draw_arrow(Picture& picture, int x, int bottom, int length, const std::string& word,
                Rgb8 colour) {
    const int tip = bottom - length;
    for (int v = 0; v < length; ++v) {
        const int half = v < kHeadLength ? std::clamp(v / 2, 1, kHeadHalfWidth) : 1;
        picture.fill(x - half, tip + v, 2 * half + 1, 1, colour);
    }
    picture.write(word, x - written_width(word) / 2, above(tip), colour);
}

}  // namespace glowworm

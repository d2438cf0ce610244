#include "preprocess/surface/normal_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "preprocess/plot/map_marks.h"

namespace glowworm {
namespace {

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

/// NDF length at the dark end of the colours.
constexpr float kRough = 0.8f;

constexpr Rgb8 kPaper{16, 16, 16}, kPale{200, 200, 200};

// Pixels: the strip under the plans, the discs of directions and the bar of lengths in it, and how
// narrow a half may be to hold them.
constexpr int kLegend = 152, kDisc = 40, kBarWidth = 256, kBarHeight = 20, kNarrowest = 424;

std::uint8_t to_byte(float v) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f));
}

Rgb8 colour_of_normal(const Vec3f& n) {
    return {to_byte(n.x * 0.5f + 0.5f), to_byte(n.y * 0.5f + 0.5f), to_byte(n.z * 0.5f + 0.5f)};
}

/// From dark violet over teal to yellow: lightness grows with the length.
Rgb8 colour_of_length(float ndf_length) {
    constexpr Vec3f kStops[3] = {
        {0.27f, 0.0f, 0.33f}, {0.13f, 0.57f, 0.55f}, {0.99f, 0.91f, 0.14f}};
    const float t = std::clamp((ndf_length - kRough) / (1.0f - kRough), 0.0f, 1.0f) * 2.0f;
    const int stop = t < 1.0f ? 0 : 1;
    const float f = t - static_cast<float>(stop);
    const Vec3f c = kStops[stop] * (1.0f - f) + kStops[stop + 1] * f;
    return {to_byte(c.x), to_byte(c.y), to_byte(c.z)};
}

bool is_seen_before(const Surfel& a, const Surfel& b) {
    const bool a_up = a.normal.z > 0.0f, b_up = b.normal.z > 0.0f;
    if (a_up != b_up) return a_up;
    return a_up ? a.position.z > b.position.z : a.position.z < b.position.z;
}

/// Which surfel each pixel of a plan shows.
struct Plan {
    int width = 0, height = 0;
    double scale = 0.0;               ///< pixels per metre
    std::vector<std::uint32_t> seen;  ///< [height x width] kNobody where there is none
};

Plan look_down(const SurfelCloud& cloud, int size) {
    Vec3f low = cloud.surfels[0].position, high = low;
    for (const Surfel& surfel : cloud.surfels) {
        low = component_min(low, surfel.position);
        high = component_max(high, surfel.position);
    }
    const float pixel =
        std::max({high.x - low.x, high.y - low.y, 1e-6f}) / static_cast<float>(size);
    Plan plan;
    plan.scale = 1.0 / static_cast<double>(pixel);
    plan.width = static_cast<int>((high.x - low.x) / pixel) + 1;
    plan.height = static_cast<int>((high.y - low.y) / pixel) + 1;
    const auto stride = static_cast<std::size_t>(plan.width);

    // Each surfel covers the pixels of its disc's bounding square, one at least.
    plan.seen.assign(stride * static_cast<std::size_t>(plan.height), kNobody);
    for (std::size_t i = 0; i < cloud.surfels.size(); ++i) {
        const Surfel& surfel = cloud.surfels[i];
        const float reach = std::min(surfel.radius / pixel, 8.0f);
        const float x = (surfel.position.x - low.x) / pixel,
                    y = (high.y - surfel.position.y) / pixel;
        const int right = std::min(static_cast<int>(x + reach), plan.width - 1);
        const int bottom = std::min(static_cast<int>(y + reach), plan.height - 1);
        for (int row = std::max(static_cast<int>(y - reach), 0); row <= bottom; ++row) {
            for (int column = std::max(static_cast<int>(x - reach), 0); column <= right; ++column) {
                std::uint32_t& top = plan.seen[static_cast<std::size_t>(row) * stride +
                                               static_cast<std::size_t>(column)];
                if (top == kNobody || is_seen_before(surfel, cloud.surfels[top])) {
                    top = static_cast<std::uint32_t>(i);
                }
            }
        }
    }
    return plan;
}

template <typename ColourOf>
void draw_plan(Picture& picture, const Plan& plan, int x, int y, const ColourOf& colour_of) {
    const std::uint32_t* seen = plan.seen.data();
    for (int row = 0; row < plan.height; ++row) {
        for (int column = 0; column < plan.width; ++column, ++seen) {
            if (*seen != kNobody) picture.set(x + column, y + row, colour_of(*seen));
        }
    }
}

/// The colours of all directions on the upper (or lower) half of a ball, seen from above.
void draw_directions(Picture& picture, int x, int y, float up, const std::string& words) {
    for (int v = -kDisc; v <= kDisc; ++v) {
        for (int u = -kDisc; u <= kDisc; ++u) {
            const float nx = static_cast<float>(u) / kDisc, ny = static_cast<float>(-v) / kDisc;
            const float z2 = 1.0f - nx * nx - ny * ny;
            if (z2 < 0.0f) continue;
            picture.set(x + kDisc + u, y + kDisc + v,
                        colour_of_normal({nx, ny, up * std::sqrt(z2)}));
        }
    }
    picture.write(words, x + kDisc - written_width(words) / 2, y + 2 * kDisc + 8, kPale);
}

void draw_lengths(Picture& picture, int x, int y) {
    for (int u = 0; u < kBarWidth; ++u) {
        const float part = static_cast<float>(u) / (kBarWidth - 1);
        picture.fill(x + u, y, 1, kBarHeight, colour_of_length(kRough + (1.0f - kRough) * part));
    }
    const std::string words[3] = {"0.8", "0.9", "1"};
    for (int w = 0; w < 3; ++w) {
        picture.write(words[w], x + w * (kBarWidth - written_width(words[w])) / 2,
                      y + kBarHeight + 8, kPale);
    }
}

}  // namespace

Picture plot_surfels(const SurfelCloud& cloud, int size) {
    if (cloud.surfels.empty()) return {};
    const Plan plan = look_down(cloud, std::clamp(size, 64, 8192));
    const int half = std::max(plan.width, kNarrowest) + 2 * kPlanMargin;
    Picture picture(2 * half, plan.height + kPlanMargin + kLegend, kPaper);
    draw_plan(picture, plan, kPlanMargin, kPlanMargin,
              [&](std::uint32_t i) { return colour_of_normal(cloud.surfels[i].normal); });
    draw_plan(picture, plan, half + kPlanMargin, kPlanMargin,
              [&](std::uint32_t i) { return colour_of_length(cloud.surfels[i].ndf_length); });

    const int top = plan.height + kPlanMargin + 24, bottom = picture.height - 20;
    draw_directions(picture, kPlanMargin, top, 1.0f, "faces up");
    draw_directions(picture, kPlanMargin + 3 * kDisc, top, -1.0f, "down");
    draw_arrow(picture, kPlanMargin + 6 * kDisc, bottom, 64, "Y", kPale);
    draw_scale_bar(picture, kPlanMargin + 7 * kDisc, bottom, 3 * kDisc, plan.scale, kPale);
    picture.write("NDF length: from rough to flat", half + kPlanMargin, top, kPale);
    draw_lengths(picture, half + kPlanMargin, top + kLineHeight);
    return picture;
}

}  // namespace glowworm

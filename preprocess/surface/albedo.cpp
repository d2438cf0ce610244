#include "preprocess/surface/albedo.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace glowworm {
namespace {

/// Natural rock is neither blacker nor whiter.
constexpr float kDarkest = 0.02f;
constexpr float kBrightest = 0.95f;

const std::array<float, 256>& linear_table() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double s = static_cast<double>(i) / 255.0;
            values[i] =
                static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
        }
        return values;
    }();
    return table;
}

/// Median of the finite values; 0 where there are none.
float median(std::vector<float> values) {
    std::erase_if(values, [](float v) { return !std::isfinite(v); });
    if (values.empty()) return 0.0f;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

float srgb_to_linear(std::uint8_t byte) {
    return linear_table()[byte];
}

std::uint8_t linear_to_srgb(float linear) {
    const auto& table = linear_table();
    const auto above = std::lower_bound(table.begin(), table.end(), linear);
    if (!(linear > 0.0f)) return 0;
    if (above == table.end()) return 255;
    const auto index = static_cast<std::size_t>(above - table.begin());
    const bool nearer_below = index > 0 && linear - table[index - 1] < table[index] - linear;
    return static_cast<std::uint8_t>(nearer_below ? index - 1 : index);
}

Vec3f to_linear(const Rgb8& colour) {
    return {srgb_to_linear(colour.r), srgb_to_linear(colour.g), srgb_to_linear(colour.b)};
}

Rgb8 to_srgb(const Vec3f& linear) {
    return {linear_to_srgb(linear.x), linear_to_srgb(linear.y), linear_to_srgb(linear.z)};
}

std::vector<Rgb8> albedo_bytes(const Points& points, float default_albedo, AlbedoSource& source) {
    // A scanner that took no pictures often writes black: that is no colour.
    const bool any_colour = std::any_of(points.colours.begin(), points.colours.end(),
                                        [](const Rgb8& colour) { return colour != Rgb8{}; });
    if (any_colour) {
        source = AlbedoSource::kColours;
        return points.colours;
    }
    const float middle = points.intensities.empty() ? 0.0f : median(points.intensities);
    if (!(middle > 0.0f)) {
        source = AlbedoSource::kDefault;
        return std::vector<Rgb8>(points.size(),
                                 to_srgb({default_albedo, default_albedo, default_albedo}));
    }
    source = AlbedoSource::kIntensities;
    std::vector<Rgb8> bytes;
    bytes.reserve(points.size());
    for (const float intensity : points.intensities) {
        const float scaled =
            std::isfinite(intensity) ? intensity / middle * default_albedo : default_albedo;
        const std::uint8_t grey = linear_to_srgb(std::clamp(scaled, kDarkest, kBrightest));
        bytes.push_back({grey, grey, grey});
    }
    return bytes;
}

}  // namespace glowworm

#include "preprocess/surface/plot.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "octree/atomic_file.h"
#include "octree/error.h"

namespace glowworm {
namespace {

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

/// NDF length at the dark end of the colours.
constexpr float kRough = 0.8f;

using Colour = std::array<std::uint8_t, 3>;

std::uint8_t to_byte(float v) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f));
}

Colour colour_of_normal(const Vec3f& n) {
    return {to_byte(n.x * 0.5f + 0.5f), to_byte(n.y * 0.5f + 0.5f), to_byte(n.z * 0.5f + 0.5f)};
}

/// From dark violet over teal to yellow: lightness grows with the length.
Colour colour_of_length(float ndf_length) {
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

}  // namespace

PlanView plot_surfels(const SurfelCloud& cloud, int size) {
    PlanView picture;
    if (cloud.surfels.empty()) return picture;
    size = std::clamp(size, 64, 8192);
    Vec3f low = cloud.surfels[0].position, high = low;
    for (const Surfel& surfel : cloud.surfels) {
        low = component_min(low, surfel.position);
        high = component_max(high, surfel.position);
    }
    const float pixel =
        std::max({high.x - low.x, high.y - low.y, 1e-6f}) / static_cast<float>(size);
    const int width = static_cast<int>((high.x - low.x) / pixel) + 1;
    const int height = static_cast<int>((high.y - low.y) / pixel) + 1;
    const auto plan = static_cast<std::size_t>(width);

    // Each surfel covers the pixels of its disc's bounding square, one at least.
    std::vector<std::uint32_t> seen(plan * static_cast<std::size_t>(height), kNobody);
    for (std::size_t i = 0; i < cloud.surfels.size(); ++i) {
        const Surfel& surfel = cloud.surfels[i];
        const float reach = std::min(surfel.radius / pixel, 8.0f);
        const float x = (surfel.position.x - low.x) / pixel,
                    y = (high.y - surfel.position.y) / pixel;
        const int right = std::min(static_cast<int>(x + reach), width - 1);
        const int bottom = std::min(static_cast<int>(y + reach), height - 1);
        for (int row = std::max(static_cast<int>(y - reach), 0); row <= bottom; ++row) {
            for (int column = std::max(static_cast<int>(x - reach), 0); column <= right; ++column) {
                std::uint32_t& top =
                    seen[static_cast<std::size_t>(row) * plan + static_cast<std::size_t>(column)];
                if (top == kNobody || is_seen_before(surfel, cloud.surfels[top])) {
                    top = static_cast<std::uint32_t>(i);
                }
            }
        }
    }

    picture.width = 2 * width;
    picture.height = height;
    picture.pixels.assign(seen.size() * 2 * 3, 0);
    for (std::size_t p = 0; p < seen.size(); ++p) {
        if (seen[p] == kNobody) continue;
        const Surfel& surfel = cloud.surfels[seen[p]];
        const std::size_t left = (p / plan * 2 * plan + p % plan) * 3;
        std::ranges::copy(colour_of_normal(surfel.normal),
                          picture.pixels.begin() + static_cast<std::ptrdiff_t>(left));
        std::ranges::copy(colour_of_length(surfel.ndf_length),
                          picture.pixels.begin() + static_cast<std::ptrdiff_t>(left + plan * 3));
    }
    return picture;
}

void write_png(const PlanView& picture, const std::filesystem::path& path) {
    if (picture.pixels.empty()) {
        throw Error(ExitCode::kDegenerate, "There are no surfels to draw into \"" + path.string() +
                                               "\"; check the input cloud.");
    }
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(picture.width);
    image.height = static_cast<png_uint_32>(picture.height);
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t bytes = 0;
    std::vector<std::uint8_t> encoded;
    bool done = png_image_write_to_memory(&image, nullptr, &bytes, 0, picture.pixels.data(), 0,
                                          nullptr) != 0;
    if (done) {
        encoded.resize(bytes);
        done = png_image_write_to_memory(&image, encoded.data(), &bytes, 0, picture.pixels.data(),
                                         0, nullptr) != 0;
    }
    if (!done) {
        throw Error(ExitCode::kInternal, "The picture \"" + path.string() +
                                             "\" cannot be encoded: " + image.message + ".");
    }
    AtomicFile file(path);
    file.write(encoded.data(), bytes);
    file.commit();
}

}  // namespace glowworm

#include "preprocess/read/missing_values.h"

#include <cmath>

namespace glowworm {
namespace {

/// Replaces the values whose flag is set by `filler`; returns how many.
template <typename T>
std::uint64_t replace_missing(std::span<const std::uint8_t> missing, const T& filler,
                              std::vector<T>& values) {
    std::uint64_t replaced = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (missing[i] == 0) continue;
        values[i] = filler;
        ++replaced;
    }
    return replaced;
}

}  // namespace

std::uint64_t fill_missing(std::span<const std::uint8_t> missing, std::vector<Rgb8>& colours) {
    std::uint64_t there = 0, r = 0, g = 0, b = 0;
    for (std::size_t i = 0; i < colours.size(); ++i) {
        if (missing[i] != 0) continue;
        r += colours[i].r;
        g += colours[i].g;
        b += colours[i].b;
        ++there;
    }
    Rgb8 filler{188, 188, 188};
    if (there > 0) {
        const auto mean = [there](std::uint64_t sum) {
            return static_cast<std::uint8_t>((sum + there / 2) / there);
        };
        filler = {mean(r), mean(g), mean(b)};
    }
    return replace_missing(missing, filler, colours);
}

std::uint64_t fill_missing(std::span<const std::uint8_t> missing, std::vector<float>& intensities) {
    double sum = 0.0;
    std::uint64_t there = 0;
    for (std::size_t i = 0; i < intensities.size(); ++i) {
        if (missing[i] != 0 || !std::isfinite(intensities[i])) continue;
        sum += static_cast<double>(intensities[i]);
        ++there;
    }
    const float filler = there > 0 ? static_cast<float>(sum / static_cast<double>(there)) : 0.5f;
    return replace_missing(missing, filler, intensities);
}

}  // namespace glowworm

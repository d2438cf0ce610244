#include "viewer/frame/exposure.h"

#include <algorithm>
#include <cmath>

namespace glowworm {
namespace {

constexpr double kMiddleGrey = 0.18;
constexpr double kLowest = 0.20, kHighest = 0.95;  // percentiles that count

}  // namespace

double measured_exposure(std::vector<float> luminances) {
    std::erase_if(luminances, [](float l) { return !(l > 0.0f) || !std::isfinite(l); });
    if (luminances.empty()) return 0.0;
    std::sort(luminances.begin(), luminances.end());
    const double n = static_cast<double>(luminances.size());
    const auto first = static_cast<std::size_t>(kLowest * n);
    const auto last = std::max(static_cast<std::size_t>(kHighest * n), first + 1);
    double sum = 0;
    for (std::size_t i = first; i < last; ++i)
        sum += std::log2(static_cast<double>(luminances[i]));
    return std::log2(kMiddleGrey) - sum / static_cast<double>(last - first);
}

double measured_exposure(const FrameLayers& layers) {
    std::vector<float> luminances;
    for (std::size_t i = 0; i < layers.depth.size(); ++i) {
        if (layers.depth[i] <= 0.0f) continue;
        luminances.push_back(dot(layers.beauty(i), Vec3f{0.2126f, 0.7152f, 0.0722f}));
    }
    return measured_exposure(std::move(luminances));
}

}  // namespace glowworm

#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "viewer/frame/layers.h"
#include "viewer/gpu/program.h"

namespace glowworm {

enum class ToneCurve : std::uint32_t { kLinear = 0, kReinhard = 1, kAces = 2, kAgx = 3 };

/// The names of --tonemap, in the order of ToneCurve.
inline constexpr const char* kToneCurveNames[] = {"linear", "reinhard", "aces", "agx"};

struct DisplaySettings {
    std::optional<double> exposure;  ///< stops; without it, measured from the picture
    ToneCurve curve = ToneCurve::kAgx;
};

/// From radiance to what a screen shows.
class Display {
  public:
    Display() = default;

    /// A frame as a picture, exposed by `stops`. On the GPU, a strip at a time.
    Picture picture_of(const FrameLayers& layers, double stops, ToneCurve curve);

    /// [width * height] vec4 on the GPU becomes `target`, an RGBA8 texture of that size.
    void draw(const Buffer& beauty, const Texture& target, double stops, ToneCurve curve);

    /// A sparse sample of the luminances in `beauty`, W·sr⁻¹·m⁻², for measured_exposure.
    std::vector<float> luminances(const Buffer& beauty, int width, int height);

  private:
    Program tonemap_{{"tonemap.comp"}}, luminance_{{"luminance.comp"}};
    Buffer luminances_;
};

}  // namespace glowworm

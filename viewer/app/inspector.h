#pragma once

#include "viewer/frame/display.h"
#include "viewer/frame/frame.h"
#include "viewer/gpu/program.h"

namespace glowworm {

/// What of a frame a window shows.
enum class Layer : std::uint32_t {
    kPicture = 0,
    kDirect,
    kIndirect,
    kAlbedo,
    kNormals,
    kNdfLength,
    kDepth
};

inline constexpr const char* kLayerNames[] = {"picture", "direct light", "indirect light", "albedo",
                                              "normals", "NDF length",   "depth"};

/// Shows what lies behind a picture: one layer of the frame last drawn.
class Inspector {
  public:
    /// Into `target`, an RGBA8 texture of the frame's size. Light is exposed by `stops`; normals
    /// are colours, x east, y north, z up; depth repeats every metre.
    void draw(const Frame& frame, Layer layer, const Texture& target, double stops,
              ToneCurve curve);

  private:
    Program inspect_{{"inspect.comp"}};
};

}  // namespace glowworm

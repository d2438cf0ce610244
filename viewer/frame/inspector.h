#pragma once

#include <optional>

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
    kDepth,
    kUnlit,     ///< points by themselves, as a lamp at the eye would show them
    kVoxels,    ///< a colour for each of the octree's cells
    kOpacity,   ///< of the cell, from where the camera is
    kRadiance,  ///< of the cell, toward the camera
};

inline constexpr const char* kLayerNames[] = {"picture", "direct light", "indirect light", "albedo",
                                              "normals", "NDF length",   "depth",          "unlit",
                                              "voxels",  "opacity",      "radiance"};

/// Whether a layer shows one level of the octree, as cones see it.
constexpr bool of_octree(Layer layer) {
    return layer >= Layer::kVoxels;
}

struct InspectorSettings {
    Layer layer = Layer::kPicture;
    int level = 0;  ///< 0 .. the light's depth
    double stops = 0.0;
    ToneCurve curve = ToneCurve::kAgx;
};

/// Shows what lies behind a picture: one layer of the frame last drawn.
class Inspector {
  public:
    /// Into `target`, an RGBA8 texture of the frame's size. Without light (nullptr) it shows
    /// surfaces only. Light is exposed by `stops`; normals are colours, x east, y north, z up;
    /// depth repeats every metre.
    void draw(const Frame& frame, const LightField* light, const InspectorSettings& settings,
              const Texture& target);

  private:
    Program inspect_{{"inspect.comp"}};
    std::optional<Program> inspect_octree_;  // compiled when first asked for
};

}  // namespace glowworm

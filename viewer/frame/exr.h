#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "viewer/frame/layers.h"
#include "viewer/frame/view.h"

namespace glowworm {

/// An OpenEXR file's bytes: 32-bit float channels R G B (the beauty), direct.*, indirect.*,
/// specular.*, emission.*, albedo.*, N.X N.Y N.Z, Z and ndf.len; chromaticities of Rec.709,
/// worldToCamera (x right, y up, z backward) and worldToNDC (x and y in [-1, 1], y up) for row
/// vectors. The same layers give the same bytes.
std::string encode_exr(const FrameLayers& layers, const View& view);

/// Any EXR's channels as floats, row 0 at the top.
struct ExrChannels {
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> channels;  ///< [height * width] each
};

/// Throws Error (kUnreadable) for anything that OpenEXR cannot read.
ExrChannels read_exr(const std::filesystem::path& path);

}  // namespace glowworm

#pragma once

#include <filesystem>

#include "viewer/frame/display.h"
#include "viewer/frame/view.h"

namespace glowworm {

/// Writes a frame as EXR or PNG, by the ending of `path`. Returns the stops a PNG was exposed by, 0
/// for an EXR. Throws Error as AtomicFile does.
double write_frame(const FrameLayers& layers, const View& view, const DisplaySettings& settings,
                   const std::filesystem::path& path);

/// Writes `bytes` under `path`, whole or not at all.
void write_whole(const std::filesystem::path& path, const std::string& bytes);

}  // namespace glowworm

#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octree/progress.h"
#include "viewer/app/camera_path.h"
#include "viewer/app/cave.h"
#include "viewer/app/grouped_light.h"
#include "viewer/app/options.h"
#include "viewer/app/start.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// Reads options.path and looks whether its output can be written, before any light is computed.
/// Throws Error for a bad path, an output that is there without --force, a video without ffmpeg.
CameraPath prepare_flight(const Options& options);

/// Draws the frames of `path` into a video, or into a folder as 000000.png (or .exr) and on; either
/// appears once it is whole. Exposure follows the pictures as an eye adapts, unless it is given. A
/// scene of our own has a headlamp that is carried along: its light goes on from the frame before.
/// `grouped` light's groups follow the camera; null where each lobe has its own. `progress` counts
/// frames. Returns what --json prints.
nlohmann::ordered_json render_flight(const Context& context, const Cave& cave, LightField& light,
                                     GroupedLight* grouped, const Start& start,
                                     const CameraPath& path, const Options& options,
                                     const Progress& progress);

}  // namespace glowworm

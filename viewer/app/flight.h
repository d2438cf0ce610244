#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octree/progress.h"
#include "viewer/app/cave.h"
#include "viewer/app/options.h"
#include "viewer/app/start.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// Draws the frames of options.path as 000000.png and on into the folder options.output, which
/// appears once all are there. Exposure follows the pictures as an eye adapts, unless it is given.
/// `progress` counts frames. Returns what --json prints.
nlohmann::ordered_json render_flight(const Context& context, const Cave& cave,
                                     const LightField& light, const Start& start,
                                     const Options& options, const Progress& progress);

}  // namespace glowworm

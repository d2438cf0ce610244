#pragma once

#include <nlohmann/json_fwd.hpp>

#include "viewer/app/cave.h"
#include "viewer/app/options.h"
#include "viewer/app/start.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// Draws options.frames frames of the start's camera, each after one more bounce of light, and
/// writes median, least and most GPU and CPU ms of each pass to options.stats. One frame before
/// them is not counted. Returns what it wrote.
nlohmann::ordered_json run_benchmark(const Context& context, const Cave& cave, LightField& light,
                                     const Start& start, const Options& options);

}  // namespace glowworm

#pragma once

#include <nlohmann/json_fwd.hpp>

#include "viewer/app/cave.h"
#include "viewer/app/console.h"
#include "viewer/app/options.h"

namespace glowworm {

/// Renders one frame, or measures probes, into the options' output. Returns what --json prints.
nlohmann::ordered_json run_headless(const Options& options, const Cave& cave, Console& console);

}  // namespace glowworm

#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "preprocess/pipeline.h"

namespace glowworm {

/// Under which each stage keeps what it made: the hash of this program, the stage's settings and
/// the keys of what it was made from, so that a change makes everything after it anew and nothing
/// before it.
struct StageKeys {
    std::vector<std::string> ingest;  ///< one an input
    std::string registration, cloud, surfels, octree;
};

StageKeys stage_keys(std::span<const ScanInput> inputs, const ConvertSettings& settings);

}  // namespace glowworm

#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "preprocess/command/command.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// What is in a scan file. Prints a table for people unless --json was given.
nlohmann::ordered_json scan_info(const std::filesystem::path& path, const ReadSettings& settings,
                                 Run& run);

}  // namespace glowworm

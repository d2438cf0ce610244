#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace glowworm {

/// By content, not by name; false for what cannot be read.
bool is_octree_file(const std::filesystem::path& path);

/// What is in an octree file, as interface.md has it. Prints a table for people unless `json`;
/// where `plot` names a PNG, draws its levels there.
nlohmann::ordered_json octree_info(const std::filesystem::path& path, bool json,
                                   const std::filesystem::path& plot = {});

}  // namespace glowworm

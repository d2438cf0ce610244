#pragma once

#include <filesystem>
#include <string>

#include "viewer/app/cave.h"

namespace glowworm {

/// What is in an octree file, a line each, for people.
std::string file_facts(const std::filesystem::path& path, const Cave& cave);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "viewer/app/cave.h"

namespace glowworm {

/// What is in an octree file, a line each, for people.
std::string file_facts(const std::filesystem::path& path, const Cave& cave);

/// Memory that this program holds, bytes; 0 where the system does not say.
std::uint64_t resident_bytes();

}  // namespace glowworm

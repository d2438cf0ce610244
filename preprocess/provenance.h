#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "octree/progress.h"

namespace glowworm {

class SharedProgress;

/// One input of a conversion, so that a file says what it was made from.
struct InputFile {
    std::string file;  ///< name without its folder: a moved folder gives the same bytes
    std::uint64_t bytes = 0;
    std::string hash;  ///< XXH3-128 of the content, 32 hexadecimal digits
};

/// Reads the file once, in blocks, and tells `progress` of each. Throws Error (kUnreadable) where
/// it cannot be read.
InputFile describe_input(const std::filesystem::path& path, SharedProgress* progress = nullptr);

/// All of them, several at a time, in their order. `progress` counts bytes.
std::vector<InputFile> describe_inputs(std::span<const std::filesystem::path> paths,
                                       const Progress& progress = {});

/// The provenance object of interface.md as compact JSON. `command` holds only what decides the
/// result, never thread counts or paths, so that equal work gives equal bytes. `settings`, where it
/// is not empty, is the hash of all settings, the defaults too.
std::string provenance_json(const std::string& command, std::span<const InputFile> inputs,
                            const std::string& settings = {});

}  // namespace glowworm

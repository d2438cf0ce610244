#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "octree/error.h"
#include "preprocess/read/read_scans.h"
#include "testing.h"

namespace glowworm::testing {

/// Writes `content` byte for byte.
inline std::filesystem::path write_file(const std::filesystem::path& path,
                                        std::string_view content) {
    std::ofstream(path, std::ios::binary)
        .write(content.data(), static_cast<std::streamsize>(content.size()));
    return path;
}

inline std::string file_content(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The scans of a file of this content.
inline std::vector<Scan> scans_from(std::string_view content, const ReadSettings& settings = {},
                                    ReadReport* report = nullptr) {
    const ScratchFolder folder;
    return read_scans(write_file(folder / "scan", content), settings, report);
}

/// How reading a file ends: its exit code, kDone where it is read, and the sentence.
struct Outcome {
    ExitCode code = ExitCode::kDone;
    std::string sentence;
};

inline Outcome outcome_of_reading(const std::filesystem::path& path,
                                  const ReadSettings& settings = {}) {
    try {
        read_scans(path, settings);
    } catch (const Error& error) {
        return {error.code(), error.what()};
    }
    return {};
}

inline Outcome outcome_of(std::string_view content, const ReadSettings& settings = {}) {
    const ScratchFolder folder;
    return outcome_of_reading(write_file(folder / "scan", content), settings);
}

}  // namespace glowworm::testing

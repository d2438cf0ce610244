#pragma once

#include <filesystem>
#include <string>

namespace glowworm {

/// What tables and pictures call a scan: its entry in poses.json without its folders.
inline std::string short_name(const std::string& pose_file) {
    return std::filesystem::path(pose_file).filename().string();
}

}  // namespace glowworm

#pragma once

#include <filesystem>

#include "preprocess/points.h"

namespace glowworm {

/// Writes a cloud in the format that the path's extension names: .ply or .pcd, whatever its case.
/// Throws Error: kUsage for another extension, else as AtomicFile.
void write_cloud(const PointCloud& cloud, const std::filesystem::path& path);

/// Throws what write_cloud would throw for the extension: to be asked before hours of work.
void check_cloud_extension(const std::filesystem::path& path);

}  // namespace glowworm

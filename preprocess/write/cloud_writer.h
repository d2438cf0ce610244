#pragma once

#include <filesystem>
#include <span>

#include "preprocess/points.h"
#include "preprocess/write/records.h"

namespace glowworm {

/// Writes a cloud in the format that the path's extension names: .ply, .pcd, .las or .e57, whatever
/// its case. PLY alone keeps extra columns. Throws Error: kUsage for another extension, else as
/// AtomicFile.
void write_cloud(const PointCloud& cloud, const std::filesystem::path& path,
                 std::span<const ExtraColumn> extra = {});

/// Throws what write_cloud would throw for the extension: to be asked before hours of work.
void check_cloud_extension(const std::filesystem::path& path);

}  // namespace glowworm

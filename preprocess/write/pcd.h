#pragma once

#include <filesystem>

#include "preprocess/points.h"

namespace glowworm {

/// Writes a cloud as binary PCD 0.7 for the Point Cloud Library: x y z (float, relative to the
/// origin), normal_x normal_y normal_z, rgb (packed), and the other columns as in write_ply, with
/// origin, stations and lights as `#` lines (cloud_comments.h). read_cloud gives the same cloud
/// back, bit for bit. Throws Error as AtomicFile.
void write_pcd(const PointCloud& cloud, const std::filesystem::path& path);

}  // namespace glowworm

#pragma once

#include <filesystem>

#include "preprocess/points.h"

namespace glowworm {

/// Writes a cloud as LAS 1.4, point format 7 (6 without colours), in the world frame. The step of
/// the coordinates is the smallest power of ten from 0.01 mm on that spans the cloud, their offset
/// its origin. Stations are the point source (1 for the first, 0 from the 65536th on), intensities
/// fill 16 bits, normals are extra bytes named NormalX, NormalY, NormalZ. Throws Error as
/// AtomicFile.
void write_las(const PointCloud& cloud, const std::filesystem::path& path);

}  // namespace glowworm

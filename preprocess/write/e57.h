#pragma once

#include <filesystem>

#include "preprocess/points.h"

namespace glowworm {

/// Writes a cloud as E57 1.0 with one scan per station: its points in the station's own frame, and
/// the station as the scan's pose, so that the set of scans opens in other programs as it was
/// registered here. Points without stations are one scan whose pose is the cloud's origin.
/// Coordinates are float, double in scans that reach farther than 1 km from their station. Throws
/// Error as AtomicFile.
void write_e57(const PointCloud& cloud, const std::filesystem::path& path);

}  // namespace glowworm

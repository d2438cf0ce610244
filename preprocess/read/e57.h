#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "preprocess/read/input_file.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

bool is_e57(std::span<const std::byte> head);

/// E57 1.0: every scan with its pose, in the scan's own frame. Cartesian or spherical coordinates;
/// points marked invalid are left out and counted; colours are scaled by their declared limits to
/// 0..255, intensities to 0..1 where limits are declared. Points marked as without colour or
/// intensity get those of the others (missing_values.h) and are counted. Rows and columns of
/// organised scans are kept. Normals by the nor: extension. Images are passed over.
std::unique_ptr<ScanFile> open_e57(InputFile file, const ReadSettings& settings);

}  // namespace glowworm

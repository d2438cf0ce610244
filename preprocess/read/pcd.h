#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "preprocess/read/input_file.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

bool is_pcd(std::span<const std::byte> head);

/// PCD: ascii, binary, and binary_compressed, which lies in memory as a whole since its columns
/// come one after the other. One scan; its VIEWPOINT is the pose unless it is PCD's default.
std::unique_ptr<ScanFile> open_pcd(InputFile file, const ReadSettings& settings);

}  // namespace glowworm

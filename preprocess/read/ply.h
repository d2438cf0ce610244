#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "preprocess/read/input_file.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

bool is_ply(std::span<const std::byte> head);

/// PLY in ascii and in both byte orders: properties in any order and of any type, lists and other
/// elements (faces) passed over. One scan, without a pose. A `vertex` element of no points is a
/// scan of no points; a file without one has none either.
std::unique_ptr<ScanFile> open_ply(InputFile file, const ReadSettings& settings);

}  // namespace glowworm

#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "preprocess/read/input_file.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

bool is_ptx(std::span<const std::byte> head);

/// PTX (Leica): per scan a grid of columns x rows, the scanner's position and axes, the 4x4 matrix
/// that takes the points to the world (row vectors: its last row is the translation), then per line
/// x y z intensity and optionally red green blue; 0 0 0 is no return. Points keep their row and
/// column. A matrix that is not rigid is applied to the points instead of being the pose. A single
/// scan with the identity was not registered and has no pose. A file that ends within a scan yields
/// what is there.
std::unique_ptr<ScanFile> open_ptx(InputFile file, const ReadSettings& settings);

}  // namespace glowworm

#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "preprocess/read/input_file.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

bool is_las(std::span<const std::byte> head);

/// LAS 1.0 to 1.4, point formats 0 to 10, and LAZ (LASzip's chunked and layered compression; COPC
/// files are such). One scan without a pose. Points that the file marks as withheld are left out
/// and counted as invalid. Extra bytes named as normals (NormalX, nx ...) are read as such.
std::unique_ptr<ScanFile> open_las(InputFile file, const ReadSettings& settings);

}  // namespace glowworm

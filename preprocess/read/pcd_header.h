#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "preprocess/read/input_file.h"
#include "preprocess/read/records.h"

namespace glowworm {

struct PcdField {
    std::string name;
    ScalarType type = ScalarType::kF32;
    std::size_t count = 1;  ///< values per point
};

enum class PcdEncoding { kAscii, kBinary, kBinaryCompressed };

struct PcdHeader {
    std::string version;  ///< "0.7"
    std::vector<PcdField> fields;
    std::uint64_t width = 0, height = 1;
    std::uint64_t points = 0;
    std::optional<Eigen::Isometry3d> viewpoint;  ///< none where it is the identity, PCD's default
    PcdEncoding encoding = PcdEncoding::kAscii;
    std::vector<std::string> comments;  ///< without '#'
    std::uint64_t data_offset = 0;      ///< byte where the points begin

    std::size_t record_bytes() const;  ///< of a point in binary
};

/// Reads the header of a PCD file (Point Cloud Library, versions .5 to .7). Throws Error
/// (kUnreadable) where it is malformed or longer than 4096 lines.
PcdHeader read_pcd_header(const InputFile& file);

}  // namespace glowworm

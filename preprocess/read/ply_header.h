#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "preprocess/read/input_file.h"
#include "preprocess/read/records.h"

namespace glowworm {

struct PlyProperty {
    std::string name;
    ScalarType type = ScalarType::kF32;         ///< of the value, or of a list's elements
    std::optional<ScalarType> list_count_type;  ///< there for lists
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    bool has_lists() const;
    std::size_t record_bytes() const;  ///< in binary files, of an element without lists
};

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::kAscii;
    std::string version;                ///< "1.0"
    std::vector<PlyElement> elements;   ///< in the order of the file
    std::vector<std::string> comments;  ///< comment and obj_info lines without these words
    std::uint64_t data_offset = 0;      ///< byte where the first element begins
};

/// Reads the header of a PLY file (Turk 1994, with the type names in use since: int8, float32,
/// bool). Throws Error (kUnreadable) where it is malformed or longer than 4096 lines.
PlyHeader read_ply_header(const InputFile& file);

}  // namespace glowworm

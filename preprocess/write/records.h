#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "preprocess/points.h"

namespace glowworm {

/// A value of a point as it lies in a written record.
struct WrittenField {
    std::string_view name;  ///< "nx"
    std::string_view type;  ///< PLY's word: "float", "uchar", "uint", "double"
    std::size_t bytes;
};

enum class ColourForm {
    kThreeBytes,   ///< red green blue, as PLY has them
    kPacked,       ///< one field `rgb`, 0x00RRGGBB, as PCD has it
};

/// The fields of the columns that `points` has, in the order of the record.
std::vector<WrittenField> written_fields(const Points& points, ColourForm form);

/// Points [begin, end) as little-endian records without gaps.
std::vector<std::byte> write_records(const Points& points, ColourForm form, std::size_t begin,
                                     std::size_t end);

}  // namespace glowworm

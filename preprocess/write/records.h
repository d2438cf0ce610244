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

/// The fields of the columns that `points` has, in the order of the record.
std::vector<WrittenField> written_fields(const Points& points);

/// Points [begin, end) as little-endian records without gaps.
std::vector<std::byte> write_records(const Points& points, std::size_t begin, std::size_t end);

}  // namespace glowworm

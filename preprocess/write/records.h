#pragma once

#include <cstddef>
#include <span>
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
    kThreeBytes,  ///< red green blue, as PLY has them
    kPacked,      ///< one field `rgb`, 0x00RRGGBB, as PCD has it
};

/// A column that no stage reads again: it follows those that `Points` has.
struct ExtraColumn {
    std::string_view name;
    std::span<const float> values;  ///< [n] as many as the points
};

/// The fields of the columns that `points` has and of the extra ones, in the order of the record.
std::vector<WrittenField> written_fields(const Points& points, ColourForm form,
                                         std::span<const ExtraColumn> extra = {});

/// Points [begin, end) as little-endian records without gaps.
std::vector<std::byte> write_records(const Points& points, ColourForm form, std::size_t begin,
                                     std::size_t end, std::span<const ExtraColumn> extra = {});

}  // namespace glowworm

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "preprocess/read/columns.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// Points as binary records, the form in which PLY, PCD and (once parsed) text arrive.
enum class ScalarType : std::uint8_t { kI8, kU8, kI16, kU16, kI32, kU32, kI64, kU64, kF32, kF64 };

std::size_t scalar_bytes(ScalarType type);
std::string_view scalar_name(ScalarType type);  ///< "uint16", "float32"

/// Where the values of one column lie: value i at `offset + i * stride` bytes.
struct RecordField {
    Column column = Column::kNone;
    ScalarType declared = ScalarType::kF32;  ///< as the file declares it: decides colour depth
    ScalarType stored = ScalarType::kF32;    ///< as it lies in the records (text: kF64)
    std::size_t offset = 0;
    std::size_t stride = 0;
};

struct RecordLayout {
    std::vector<RecordField> fields;  ///< those with a column; each column at most once
    bool swapped = false;             ///< big-endian values
    float colour_factor = 1.0f;       ///< file's channel to 0..255, see choose_colour_factor
    float colour_rounding = 0.0f;     ///< added before the fraction is cut off
};

/// The columns that a block read through `layout` has: of three coordinates all must be there.
ColumnSet columns_of(const RecordLayout& layout);

/// Whether x, y and z are all there.
bool has_positions(const RecordLayout& layout);

/// Bits of a colour channel as the file declares it: 8, 16, 32 for floats, 0 without colour.
int colour_bits(const RecordLayout& layout);

/// Sets how colours become 0..255, from the declared type and the largest value among the first
/// `count` records: bytes stay; wider integers keep their high byte unless nothing exceeds 255;
/// floats are 0..1, or 0..255 where something exceeds 1, or 0..65535 where something exceeds 255.
void choose_colour_factor(RecordLayout& layout, const std::byte* records, std::size_t count);

/// Fills points [first, first + count) of `block`, which must have been resized with
/// columns_of(layout), from `count` records.
void decode_records(const RecordLayout& layout, const std::byte* records, std::size_t count,
                    std::size_t first, PointBlock& block);

}  // namespace glowworm

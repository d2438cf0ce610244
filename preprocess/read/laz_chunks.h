#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "preprocess/read/input_file.h"

namespace glowworm {

/// A part of a point record that is compressed by itself; the numbers are the file's.
enum class LazItemType : std::uint16_t {
    kByte = 0,
    kPoint10 = 6,
    kGpsTime11 = 7,
    kRgb12 = 8,
    kWavePacket13 = 9,
    kPoint14 = 10,
    kRgb14 = 11,
    kRgbNir14 = 12,
    kWavePacket14 = 13,
    kByte14 = 14,
};

struct LazItem {
    LazItemType type;
    std::uint32_t bytes;    ///< of it in a record
    std::uint32_t offset;   ///< in a record
    std::uint32_t version;  ///< 2 for formats 0 to 5 (wave packets 1), 3 or 4 for the layered ones
};

/// How the points of a LAZ file are compressed.
struct LazLayout {
    bool chunked = true;             ///< false: one chunk without a table
    bool layered = false;            ///< formats 6 to 10
    std::uint32_t chunk_points = 0;  ///< 0: the chunk table says, chunk by chunk
    std::uint32_t record_bytes = 0;
    std::string version;  ///< of the LASzip that wrote it, "2.2"
    std::vector<LazItem> items;
};

/// Points [first, first + points) of the file, in its bytes [begin, end).
struct LazChunk {
    std::uint64_t begin = 0, end = 0;
    std::uint64_t points = 0;
};

/// What the LASzip record (user "laszip encoded", 22204) says. Throws Error (kUnreadable) for what
/// is damaged or cannot be decoded, with a sentence that says how to convert it.
LazLayout read_laz_layout(const InputFile& file, std::span<const std::byte> record,
                          std::uint32_t record_bytes);

/// The chunks of `point_count` points that begin at `point_offset`, without those that are empty.
/// Time and memory are bounded by the bytes of the file, whatever the table claims. Throws Error
/// (kUnreadable) where the table is missing or contradicts the file.
std::vector<LazChunk> read_laz_chunks(const InputFile& file, const LazLayout& layout,
                                      std::uint64_t point_offset, std::uint64_t point_count);

}  // namespace glowworm

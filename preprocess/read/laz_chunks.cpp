#include "preprocess/read/laz_chunks.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>

#include "preprocess/read/laz_integer.h"
#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

constexpr std::uint32_t kMaxExtraBytes = 4096;  // per point; each needs models of its own
constexpr const char* kRewrite =
    "decompress it with `laszip -i IN.laz -o OUT.las` (LAStools) or `pdal translate IN.laz OUT.las`"
    " and read the .las";

struct ItemKind {
    LazItemType type;
    std::uint32_t bytes;  // 0: any
    std::uint32_t oldest, newest;
    bool layered;
};

constexpr ItemKind kItemKinds[] = {
    {LazItemType::kByte, 0, 2, 2, false},          {LazItemType::kPoint10, 20, 2, 2, false},
    {LazItemType::kGpsTime11, 8, 2, 2, false},     {LazItemType::kRgb12, 6, 2, 2, false},
    {LazItemType::kWavePacket13, 29, 1, 1, false}, {LazItemType::kPoint14, 30, 2, 4, true},
    {LazItemType::kRgb14, 6, 2, 4, true},          {LazItemType::kRgbNir14, 8, 2, 4, true},
    {LazItemType::kWavePacket14, 29, 2, 4, true},  {LazItemType::kByte14, 0, 2, 4, true},
};

template <typename T>
T read(const InputFile& file, std::uint64_t offset) {
    T value;
    file.read_exactly(offset, &value, sizeof(T));
    return value;
}

LazItem checked_item(const InputFile& file, const std::byte* at, std::uint32_t offset,
                     bool layered) {
    const auto type = load<std::uint16_t>(at);
    const LazItem item{static_cast<LazItemType>(type), load<std::uint16_t>(at + 2), offset,
                       load<std::uint16_t>(at + 4)};
    for (const ItemKind& kind : kItemKinds) {
        if (kind.type != item.type || kind.layered != layered) continue;
        if (item.bytes == 0 || (kind.bytes != 0 && item.bytes != kind.bytes)) break;
        if (kind.bytes == 0 && item.bytes > kMaxExtraBytes) {
            file.fail(
                fmt::format("it has {} extra bytes per point, at most {} are read from LAZ; {}",
                            item.bytes, kMaxExtraBytes, kRewrite));
        }
        if (item.version >= kind.oldest && item.version <= kind.newest) return item;
    }
    if (item.version == 1 && !layered) {
        file.fail(fmt::format("it was compressed by LASzip 1, which is not read; {}", kRewrite));
    }
    file.fail(fmt::format("its compression (item {}, version {}, {} bytes) is not known; {}", type,
                          item.version, item.bytes, kRewrite));
}

/// Where the chunk table lies: said before the first chunk, or, by writers that could not go back,
/// at the very end of the file.
std::uint64_t table_position(const InputFile& file, std::uint64_t point_offset) {
    auto position = read<std::int64_t>(file, point_offset);
    if (position == -1 || position == 0) {
        position = read<std::int64_t>(file, std::max<std::uint64_t>(file.size(), 8) - 8);
    }
    if (position < static_cast<std::int64_t>(point_offset + 8) ||
        static_cast<std::uint64_t>(position) > file.size() - 8) {
        file.fail(
            "its chunk table is missing, as after a copy or a conversion that was cut short; "
            "make the file again");
    }
    return static_cast<std::uint64_t>(position);
}

}  // namespace

LazLayout read_laz_layout(const InputFile& file, std::span<const std::byte> record,
                          std::uint32_t record_bytes) {
    if (record.size() < 34) file.fail("its LASzip record is damaged; copy the file again");
    const std::byte* at = record.data();
    const auto compressor = load<std::uint16_t>(at);
    const auto coder = load<std::uint16_t>(at + 2);
    const auto chunk_points = load<std::uint32_t>(at + 12);
    const auto item_count = load<std::uint16_t>(at + 32);
    if (compressor < 1 || compressor > 3 || coder != 0) {
        file.fail(fmt::format("its compressor {} with coder {} is not known; {}", compressor, coder,
                              kRewrite));
    }
    if (item_count == 0 || record.size() < 34 + std::size_t{6} * item_count) {
        file.fail("its LASzip record is damaged; copy the file again");
    }

    LazLayout layout;
    layout.chunked = compressor != 1;
    layout.layered = compressor == 3;
    layout.chunk_points = chunk_points == 0xffffffffu ? 0 : chunk_points;
    layout.record_bytes = record_bytes;
    layout.version = fmt::format("{}.{}", std::to_integer<int>(at[4]), std::to_integer<int>(at[5]));
    if (layout.chunked && chunk_points == 0) {
        file.fail("its LASzip record announces chunks of no points; copy the file again");
    }
    std::uint32_t offset = 0;
    for (std::size_t i = 0; i < item_count; ++i) {
        layout.items.push_back(checked_item(file, at + 34 + 6 * i, offset, layout.layered));
        offset += layout.items.back().bytes;
    }
    const LazItemType first = layout.layered ? LazItemType::kPoint14 : LazItemType::kPoint10;
    bool repeated = false;
    for (std::size_t i = 1; i < layout.items.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            repeated = repeated || layout.items[i].type == layout.items[j].type;
        }
    }
    if (offset != record_bytes || layout.items[0].type != first || repeated) {
        file.fail("its LASzip record contradicts its header; copy the file again");
    }
    return layout;
}

std::vector<LazChunk> read_laz_chunks(const InputFile& file, const LazLayout& layout,
                                      std::uint64_t point_offset, std::uint64_t point_count) {
    if (point_count == 0) return {};
    if (!layout.chunked) return {{point_offset, file.size(), point_count}};

    const std::uint64_t table = table_position(file, point_offset);
    const auto version = read<std::uint32_t>(file, table);
    const std::uint64_t count = read<std::uint32_t>(file, table + 4);
    const std::uint64_t first_chunk = point_offset + 8;
    // Every chunk with points begins with one of them as it is.
    if (version != 0 || count == 0 || count > (table - first_chunk) / layout.record_bytes) {
        file.fail("its chunk table is damaged; copy the file again");
    }

    ArithmeticDecoder decoder;
    decoder.open(file, table + 8, file.size());
    IntegerDecoder integers(32, 2);
    std::vector<LazChunk> chunks;
    chunks.reserve(count);
    std::uint64_t begin = first_chunk, points_left = point_count;
    std::uint32_t points = 0, bytes = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        if (layout.chunk_points == 0) {
            points = static_cast<std::uint32_t>(
                integers.next(decoder, static_cast<std::int32_t>(points), 0));
        } else {
            points = layout.chunk_points;
        }
        bytes =
            static_cast<std::uint32_t>(integers.next(decoder, static_cast<std::int32_t>(bytes), 1));
        const std::uint64_t used = std::min<std::uint64_t>(points, points_left);
        if (bytes > table - begin || (used > 0 && bytes < layout.record_bytes)) {
            file.fail("its chunk table is damaged; copy the file again");
        }
        if (used > 0) chunks.push_back({begin, begin + bytes, used});
        begin += bytes;
        points_left -= used;
    }
    if (points_left > 0) {
        file.fail(
            fmt::format("its header announces {} points but its chunks hold {}; copy it again",
                        point_count, point_count - points_left));
    }
    return chunks;
}

}  // namespace glowworm

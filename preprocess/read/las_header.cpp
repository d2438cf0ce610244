#include "preprocess/read/las_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "preprocess/read/las_crs.h"
#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

constexpr std::uint64_t kMaxRecordBytes = std::uint64_t{1} << 20;
constexpr std::uint64_t kMaxRecords = 10000;
constexpr std::size_t kExtraRecordBytes = 192;

constexpr LasPointFormat kPointFormats[] = {
    {20, 0, 0, 15, 0x80},   {28, 20, 0, 15, 0x80},  {26, 0, 20, 15, 0x80},  {34, 20, 28, 15, 0x80},
    {57, 20, 0, 15, 0x80},  {63, 20, 28, 15, 0x80}, {30, 22, 0, 15, 0x04},  {36, 22, 30, 15, 0x04},
    {38, 22, 30, 15, 0x04}, {59, 22, 0, 15, 0x04},  {67, 22, 30, 15, 0x04},
};

struct ExtraType {
    const char* name;
    std::uint32_t bytes;
};
constexpr ExtraType kExtraTypes[] = {
    {"bytes", 0}, {"uint8", 1},  {"int8", 1},  {"uint16", 2},  {"int16", 2},   {"uint32", 4},
    {"int32", 4}, {"uint64", 8}, {"int64", 8}, {"float32", 4}, {"float64", 8},
};

std::string padded_text(const std::byte* at, std::size_t bytes) {
    std::string text(reinterpret_cast<const char*>(at), bytes);
    text.resize(std::min(text.size(), text.find('\0')));
    while (!text.empty() && text.back() == ' ')
        text.pop_back();
    return text;
}

Vec3d vec3_at(const std::byte* at) {
    return {load<double>(at), load<double>(at + 8), load<double>(at + 16)};
}

/// Reads `count` records of `head_bytes` each (54, or 60 after the points) from `at` on, as far as
/// they lie before `end`.
void read_records(const InputFile& file, std::uint64_t at, std::uint64_t count,
                  std::uint64_t head_bytes, std::uint64_t end, LasHeader& header) {
    std::byte head[60];
    for (std::uint64_t i = 0; i < std::min(count, kMaxRecords); ++i) {
        const bool there = at <= end && end - at >= head_bytes;
        if (there) file.read_exactly(at, head, head_bytes);
        LasRecord record;
        if (there) {
            record.user = padded_text(head + 2, 16);
            record.id = load<std::uint16_t>(head + 18);
            record.bytes =
                head_bytes == 54 ? load<std::uint16_t>(head + 20) : load<std::uint64_t>(head + 20);
            record.offset = at + head_bytes;
        }
        if (!there || record.bytes > end - record.offset) {
            header.notes.push_back(
                fmt::format("'{}' announces {} more variable length records than it holds; they "
                            "are passed over.",
                            file.path().string(), count - i));
            return;
        }
        at = record.offset + record.bytes;
        header.records.push_back(std::move(record));
    }
}

/// The extra bytes as their record describes them, and what is left of them without a description.
void read_extra_fields(const InputFile& file, LasHeader& header) {
    const std::vector<std::byte> table = read_las_record(file, header, "LASF_Spec", 4);
    std::uint32_t position = las_point_format(header.point_format).bytes;
    for (std::size_t at = 0; at + kExtraRecordBytes <= table.size(); at += kExtraRecordBytes) {
        const std::byte* entry = table.data() + at;
        const auto code = std::to_integer<std::uint8_t>(entry[2]);
        const auto options = std::to_integer<std::uint8_t>(entry[3]);
        if (code > 30) break;
        // 11 to 30 are the deprecated arrays of two and three numbers.
        const std::uint32_t numbers = code == 0 ? 1u : (code - 1u) / 10u + 1u;
        const ExtraType& type = kExtraTypes[code == 0 ? 0 : (code - 1) % 10 + 1];
        LasExtraField field;
        field.name = padded_text(entry + 4, 32);
        field.type = numbers == 1 ? type.name : fmt::format("{} x {}", type.name, numbers);
        field.code = numbers == 1 ? code : std::uint8_t{0};
        field.position = position;
        field.bytes = code == 0 ? options : type.bytes * numbers;
        if (code != 0 && (options & 8) != 0) field.scale = load<double>(entry + 112);
        if (code != 0 && (options & 16) != 0) field.offset = load<double>(entry + 136);
        if (field.bytes > header.record_bytes - position) break;
        position += field.bytes;
        header.extra_fields.push_back(std::move(field));
    }
    if (position < header.record_bytes) {
        header.extra_fields.push_back(
            {"extra bytes", "bytes", 0, position, header.record_bytes - position, 1.0, 0.0});
    }
}

void check(const InputFile& file, const LasHeader& header, std::uint64_t header_bytes) {
    if (header.point_offset < header_bytes || header.point_offset > file.size()) {
        file.fail("its header puts the points where the file has none; copy it again");
    }
    const std::uint32_t least = las_point_format(header.point_format).bytes;
    if (header.record_bytes < least) {
        file.fail(
            fmt::format("its points have {} bytes but point format {} needs {}; export it again",
                        header.record_bytes, header.point_format, least));
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(header.scale[axis]) || header.scale[axis] == 0.0 ||
            !std::isfinite(header.offset[axis])) {
            file.fail("the scale or offset of its coordinates is no number; export it again");
        }
    }
    const std::uint64_t room = (file.size() - header.point_offset) / header.record_bytes;
    if (!header.compressed && header.point_count > room) {
        file.fail(
            fmt::format("its header announces {} points but there are bytes for {}; the file "
                        "was cut short, copy it again",
                        header.point_count, room));
    }
}

}  // namespace

double LasExtraField::value(const std::byte* record) const {
    const std::byte* at = record + position;
    double stored = 0.0;
    switch (code) {
        case 1:
            stored = load<std::uint8_t>(at);
            break;
        case 2:
            stored = load<std::int8_t>(at);
            break;
        case 3:
            stored = load<std::uint16_t>(at);
            break;
        case 4:
            stored = load<std::int16_t>(at);
            break;
        case 5:
            stored = load<std::uint32_t>(at);
            break;
        case 6:
            stored = load<std::int32_t>(at);
            break;
        case 7:
            stored = static_cast<double>(load<std::uint64_t>(at));
            break;
        case 8:
            stored = static_cast<double>(load<std::int64_t>(at));
            break;
        case 9:
            stored = static_cast<double>(load<float>(at));
            break;
        case 10:
            stored = load<double>(at);
            break;
        default:
            return 0.0;
    }
    return stored * scale + offset;
}

const LasPointFormat& las_point_format(std::uint32_t point_format) {
    return kPointFormats[point_format];
}

std::vector<std::byte> read_las_record(const InputFile& file, const LasHeader& header,
                                       const std::string& user, std::uint16_t id) {
    for (const LasRecord& record : header.records) {
        if (record.user != user || record.id != id) continue;
        if (record.bytes > kMaxRecordBytes) return {};
        std::vector<std::byte> bytes(record.bytes);
        file.read_exactly(record.offset, bytes.data(), bytes.size());
        return bytes;
    }
    return {};
}

LasHeader read_las_header(const InputFile& file) {
    constexpr std::size_t kOldest = 227, kNewest = 375;  // bytes of a header of 1.0 and of 1.4
    std::byte bytes[kNewest] = {};
    file.read_exactly(0, bytes, kOldest);

    LasHeader header;
    const int major = std::to_integer<int>(bytes[24]);
    header.version_minor = std::to_integer<int>(bytes[25]);
    if (major != 1 || header.version_minor > 4) {
        file.fail(fmt::format("it is LAS {}.{}, versions 1.0 to 1.4 are read; export it as LAS 1.4",
                              major, header.version_minor));
    }
    const std::uint64_t header_bytes = load<std::uint16_t>(bytes + 94);
    if (header_bytes < kOldest || (header.version_minor == 4 && header_bytes < kNewest)) {
        file.fail("its header is shorter than its version says; export it again");
    }
    if (header.version_minor == 4) file.read_exactly(0, bytes, kNewest);

    header.encoding = load<std::uint16_t>(bytes + 6);
    header.system = padded_text(bytes + 26, 32);
    header.software = padded_text(bytes + 58, 32);
    const auto day = load<std::uint16_t>(bytes + 90), year = load<std::uint16_t>(bytes + 92);
    if (year != 0) header.created = fmt::format("{} day {}", year, day);
    header.point_offset = load<std::uint32_t>(bytes + 96);
    // LASzip marks compressed points by the high bits of the format.
    const auto format = std::to_integer<std::uint32_t>(bytes[104]);
    header.compressed = (format & 0xc0u) != 0;
    header.point_format = format & 0x3fu;
    if (header.point_format >= std::size(kPointFormats)) {
        file.fail(fmt::format("its point format {} is not known, 0 to 10 are; export it as LAS 1.4",
                              header.point_format));
    }
    header.record_bytes = load<std::uint16_t>(bytes + 105);
    header.point_count = load<std::uint32_t>(bytes + 107);
    header.scale = vec3_at(bytes + 131);
    header.offset = vec3_at(bytes + 155);
    for (int axis = 0; axis < 3; ++axis) {
        header.bounds_max[axis] = load<double>(bytes + 179 + 16 * axis);
        header.bounds_min[axis] = load<double>(bytes + 187 + 16 * axis);
    }
    if (header.version_minor == 4) {
        const auto count = load<std::uint64_t>(bytes + 247);
        if (count != 0) header.point_count = count;
    }
    check(file, header, header_bytes);

    read_records(file, header_bytes, load<std::uint32_t>(bytes + 100), 54, header.point_offset,
                 header);
    if (header.version_minor == 4) {
        read_records(file, load<std::uint64_t>(bytes + 235), load<std::uint32_t>(bytes + 243), 60,
                     file.size(), header);
    }
    read_extra_fields(file, header);
    header.crs = las_crs(file, header);
    return header;
}

}  // namespace glowworm

#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

// LAS files made byte by byte, so that a test knows what is in them without our writer.

namespace glowworm::testing {

struct LasPoint {
    std::int32_t x = 0, y = 0, z = 0;
    std::uint16_t intensity = 0;
    bool withheld = false;
    double time = 0.0;
    std::uint16_t red = 0, green = 0, blue = 0;
};

struct LasContent {
    int minor = 2;
    int format = 3;
    double scale = 0.001;
    double offset[3] = {0.0, 0.0, 0.0};
    std::vector<LasPoint> points;
    std::string records;  ///< variable length records, heads included
    std::uint32_t record_count = 0;
    std::string extra;  ///< extra bytes of every point
};

template <typename T>
void put(std::string& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

inline std::string las_record(const std::string& user, std::uint16_t id,
                              const std::string& content) {
    std::string record(54, '\0');
    std::copy(user.begin(), user.end(), record.begin() + 2);
    put(record, 18, id);
    put(record, 20, static_cast<std::uint16_t>(content.size()));
    record += content;
    return record;
}

inline std::string las_file(const LasContent& content) {
    constexpr std::uint16_t kBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    constexpr std::size_t kTime[] = {0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22};
    constexpr std::size_t kColour[] = {0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
    const auto format = static_cast<std::size_t>(content.format);
    const std::size_t header_bytes = content.minor == 4 ? 375 : content.minor == 3 ? 235 : 227;
    const std::size_t record_bytes = kBytes[format] + content.extra.size();
    const auto count = static_cast<std::uint32_t>(content.points.size());

    std::string file(header_bytes, '\0');
    file.replace(0, 4, "LASF");
    put(file, 24, std::uint8_t{1});
    put(file, 25, static_cast<std::uint8_t>(content.minor));
    put(file, 94, static_cast<std::uint16_t>(header_bytes));
    put(file, 96, static_cast<std::uint32_t>(header_bytes + content.records.size()));
    put(file, 100, content.record_count);
    put(file, 104, static_cast<std::uint8_t>(content.format));
    put(file, 105, static_cast<std::uint16_t>(record_bytes));
    put(file, 107, content.minor == 4 && format > 5 ? 0u : count);
    if (content.minor == 4) put(file, 247, std::uint64_t{count});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        put(file, 131 + 8 * axis, content.scale);
        put(file, 155 + 8 * axis, content.offset[axis]);
    }
    file += content.records;
    for (const LasPoint& point : content.points) {
        std::string record(kBytes[format], '\0');
        put(record, 0, point.x);
        put(record, 4, point.y);
        put(record, 8, point.z);
        put(record, 12, point.intensity);
        if (point.withheld) record[15] = static_cast<char>(format > 5 ? 0x04 : 0x80);
        if (kTime[format] != 0) put(record, kTime[format], point.time);
        if (kColour[format] != 0) {
            put(record, kColour[format], point.red);
            put(record, kColour[format] + 2, point.green);
            put(record, kColour[format] + 4, point.blue);
        }
        file += record + content.extra;
    }
    return file;
}

}  // namespace glowworm::testing

#include "preprocess/read/las_crs.h"

#include <fmt/format.h>

#include <algorithm>

#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

constexpr std::uint16_t kWktRecord = 2112, kKeyRecord = 34735, kTextRecord = 34737;
constexpr std::uint16_t kTextKeyLocation = 34737;

/// GeoTIFF keys worth saying (OGC GeoTIFF 1.1, annex C).
enum Key : std::uint16_t {
    kModelCitation = 1026,
    kGeodeticSystem = 2048,
    kGeodeticCitation = 2049,
    kProjectedSystem = 3072,
    kProjectedCitation = 3073,
    kLinearUnit = 3076,
    kVerticalSystem = 4096,
    kVerticalUnit = 4099,
};

std::string text_of(const std::vector<std::byte>& bytes, std::size_t from, std::size_t count) {
    if (from >= bytes.size()) return {};
    count = std::min(count, bytes.size() - from);
    std::string text(reinterpret_cast<const char*>(bytes.data()) + from, count);
    text.resize(std::min(text.size(), text.find('\0')));
    while (!text.empty() && (text.back() == '|' || text.back() == ' '))
        text.pop_back();
    return text;
}

std::string unit_name(std::uint16_t code) {
    switch (code) {
        case 9001:
            return "metre";
        case 9002:
            return "foot";
        case 9003:
            return "US survey foot";
        case 9005:
            return "Clarke's foot";
        case 9041:
            return "British foot";
        case 9080:
            return "Indian foot";
        default:
            return fmt::format("EPSG:{}", code);
    }
}

void add(std::string& text, const std::string& part) {
    if (part.empty() || text.find(part) != std::string::npos) return;
    text += (text.empty() ? "" : ", ") + part;
}

}  // namespace

std::string las_crs(const InputFile& file, const LasHeader& header) {
    for (const char* user : {"LASF_Projection", "liblas"}) {
        const std::vector<std::byte> wkt = read_las_record(file, header, user, kWktRecord);
        if (std::string text = text_of(wkt, 0, wkt.size()); !text.empty()) return text;
    }

    const std::vector<std::byte> keys =
        read_las_record(file, header, "LASF_Projection", kKeyRecord);
    const std::vector<std::byte> texts =
        read_las_record(file, header, "LASF_Projection", kTextRecord);
    std::string crs, systems, units;
    for (std::size_t at = 8; at + 8 <= keys.size(); at += 8) {
        const auto key = load<std::uint16_t>(keys.data() + at);
        const auto location = load<std::uint16_t>(keys.data() + at + 2);
        const auto count = load<std::uint16_t>(keys.data() + at + 4);
        const auto value = load<std::uint16_t>(keys.data() + at + 6);
        const bool coded = location == 0 && value != 0 && value != 32767;  // 32767: user-defined
        switch (key) {
            case kModelCitation:
            case kGeodeticCitation:
            case kProjectedCitation:
                if (location == kTextKeyLocation) add(crs, text_of(texts, value, count));
                break;
            case kGeodeticSystem:
            case kProjectedSystem:
            case kVerticalSystem:
                if (coded) add(systems, fmt::format("EPSG:{}", value));
                break;
            case kLinearUnit:
                if (coded) add(units, "unit " + unit_name(value));
                break;
            case kVerticalUnit:
                if (coded) add(units, "vertical unit " + unit_name(value));
                break;
            default:
                break;
        }
    }
    add(crs, systems);
    add(crs, units);
    return crs;
}

}  // namespace glowworm

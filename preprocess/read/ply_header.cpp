#include "preprocess/read/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string_view>

#include "preprocess/read/line_reader.h"

namespace glowworm {
namespace {

constexpr int kMostLines = 4096;

struct TypeName {
    std::string_view name;
    ScalarType type;
};

constexpr TypeName kTypes[] = {
    {"char", ScalarType::kI8},     {"int8", ScalarType::kI8},     {"uchar", ScalarType::kU8},
    {"uint8", ScalarType::kU8},    {"bool", ScalarType::kU8},     {"short", ScalarType::kI16},
    {"int16", ScalarType::kI16},   {"ushort", ScalarType::kU16},  {"uint16", ScalarType::kU16},
    {"int", ScalarType::kI32},     {"int32", ScalarType::kI32},   {"uint", ScalarType::kU32},
    {"uint32", ScalarType::kU32},  {"int64", ScalarType::kI64},   {"uint64", ScalarType::kU64},
    {"float", ScalarType::kF32},   {"float32", ScalarType::kF32}, {"double", ScalarType::kF64},
    {"float64", ScalarType::kF64},
};

ScalarType type_named(const InputFile& file, std::string_view name) {
    const auto found = std::ranges::find(kTypes, name, &TypeName::name);
    if (found == std::end(kTypes)) {
        file.fail(fmt::format("its PLY header has the unknown type '{}'; export it again", name));
    }
    return found->type;
}

PlyEncoding encoding_named(const InputFile& file, std::string_view name) {
    if (name == "ascii") return PlyEncoding::kAscii;
    if (name == "binary_little_endian") return PlyEncoding::kLittleEndian;
    if (name == "binary_big_endian") return PlyEncoding::kBigEndian;
    file.fail(fmt::format("its PLY header has the unknown format '{}'; export it again", name));
}

PlyProperty read_property(const InputFile& file, std::string_view words) {
    PlyProperty property;
    std::string_view type = take_word(words);
    if (type == "list") {
        property.list_count_type = type_named(file, take_word(words));
        if (*property.list_count_type >= ScalarType::kF32) {
            file.fail("its PLY header counts the elements of a list in a float; export it again");
        }
        type = take_word(words);
    }
    property.type = type_named(file, type);
    property.name = take_word(words);
    if (property.name.empty()) {
        file.fail("its PLY header has a property without a name; export it again");
    }
    return property;
}

}  // namespace

bool PlyElement::has_lists() const {
    return std::ranges::any_of(properties,
                               [](const PlyProperty& p) { return p.list_count_type.has_value(); });
}

std::size_t PlyElement::record_bytes() const {
    return std::accumulate(
        properties.begin(), properties.end(), std::size_t{0},
        [](std::size_t sum, const PlyProperty& p) { return sum + scalar_bytes(p.type); });
}

PlyHeader read_ply_header(const InputFile& file) {
    PlyHeader header;
    LineReader lines(file);
    std::string_view line;
    lines.next(line);  // "ply", as was recognised
    for (int count = 0; count < kMostLines && lines.next(line); ++count) {
        std::string_view words = line;
        const std::string_view keyword = take_word(words);
        if (keyword == "end_header") {
            if (header.version.empty())
                file.fail("its PLY header has no format line; export it again");
            header.data_offset = lines.offset();
            return header;
        }
        if (keyword == "format") {
            header.encoding = encoding_named(file, take_word(words));
            header.version = take_word(words);
            if (header.version.empty()) header.version = "1.0";
        } else if (keyword == "comment" || keyword == "obj_info") {
            if (!words.empty()) words.remove_prefix(1);
            header.comments.emplace_back(words);
        } else if (keyword == "element") {
            PlyElement& element = header.elements.emplace_back();
            element.name = take_word(words);
            if (!parse_count(take_word(words), element.count)) {
                file.fail(fmt::format("its PLY header has no count of '{}'; export it again",
                                      element.name));
            }
        } else if (keyword == "property") {
            if (header.elements.empty()) {
                file.fail("its PLY header has a property before any element; export it again");
            }
            header.elements.back().properties.push_back(read_property(file, words));
        } else if (!keyword.empty()) {
            file.fail(fmt::format("its PLY header has the unknown line '{}'; export it again",
                                  line.substr(0, 80)));
        }
    }
    file.fail("its PLY header has no end; copy or export it again");
}

}  // namespace glowworm

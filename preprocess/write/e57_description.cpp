#include <fmt/format.h>

#include <algorithm>

#include "preprocess/read/e57_pages.h"
#include "preprocess/write/e57_layout.h"

namespace glowworm {
namespace {

/// Bytes of the UTF-8 character at the front of `text` that XML allows; 0 where it is none.
std::size_t character_bytes(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(0) < 0x80) {
        return byte(0) >= 0x20 && byte(0) != 0x7f ? 1 : 0;
    }
    const std::size_t bytes = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
    if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < bytes) return 0;
    std::uint32_t code = byte(0) & (0xffu >> (bytes + 1));
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return 0;
        code = code << 6 | (byte(i) & 0x3fu);
    }
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code >= 0xd800 && code <= 0xdfff;
    const bool allowed = code <= 0x10ffff && code != 0xfffe && code != 0xffff;
    return code >= kLeast[bytes] && !surrogate && allowed ? bytes : 0;
}

/// `text` with everything that XML forbids or gives a meaning replaced.
std::string escaped(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t bytes = character_bytes(text);
        if (bytes == 0) {
            out += '?';
        } else if (text[0] == '<' || text[0] == '&' || text[0] == '>') {
            out += text[0] == '<' ? "&lt;" : text[0] == '>' ? "&gt;" : "&amp;";
        } else {
            out += text.substr(0, bytes);
        }
        text.remove_prefix(std::max<std::size_t>(bytes, 1));
    }
    return out;
}

std::string guid(std::uint64_t hash, std::size_t scan) {
    const std::uint64_t low = hash * 0x9e3779b97f4a7c15ull + scan;
    return fmt::format("{{{:08x}-{:04x}-{:04x}-{:04x}-{:012x}}}", hash >> 32, (hash >> 16) & 0xffff,
                       hash & 0xffff, low >> 48, low & 0xffffffffffffull);
}

std::string number(std::string_view name, double value) {
    return fmt::format("<{0} type=\"Float\">{1:.17g}</{0}>\n", name, value);
}

std::string prototype(const E57ScanLayout& scan) {
    std::string fields;
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"}) {
        fields += fmt::format("<{} type=\"Float\" precision=\"{}\"/>\n", name,
                              scan.doubles ? "double" : "single");
    }
    if (scan.colours) {
        for (const char* name : {"colorRed", "colorGreen", "colorBlue"}) {
            fields += fmt::format("<{} type=\"Integer\" minimum=\"0\" maximum=\"255\"/>\n", name);
        }
    }
    if (scan.intensities) fields += "<intensity type=\"Float\" precision=\"single\"/>\n";
    if (scan.normals) {
        for (const char* name : {"nor:normalX", "nor:normalY", "nor:normalZ"}) {
            fields += fmt::format("<{} type=\"Float\" precision=\"single\"/>\n", name);
        }
    }
    if (scan.times) fields += "<timeStamp type=\"Float\" precision=\"double\"/>\n";
    if (scan.grid) {
        for (const char* name : {"rowIndex", "columnIndex"}) {
            fields +=
                fmt::format("<{} type=\"Integer\" minimum=\"0\" maximum=\"4294967295\"/>\n", name);
        }
    }
    return fields;
}

std::string limits(const E57ScanLayout& scan) {
    std::string text;
    if (scan.colours) {
        text += "<colorLimits type=\"Structure\">\n";
        for (const char* name : {"colorRed", "colorGreen", "colorBlue"}) {
            text += fmt::format(
                "<{0}Minimum type=\"Integer\">0</{0}Minimum>\n"
                "<{0}Maximum type=\"Integer\">255</{0}Maximum>\n",
                name);
        }
        text += "</colorLimits>\n";
    }
    if (scan.intensities && scan.most_intensity > scan.least_intensity) {
        text += "<intensityLimits type=\"Structure\">\n" +
                number("intensityMinimum", static_cast<double>(scan.least_intensity)) +
                number("intensityMaximum", static_cast<double>(scan.most_intensity)) +
                "</intensityLimits>\n";
    }
    if (!scan.indices.empty()) {
        text += "<cartesianBounds type=\"Structure\">\n" + number("xMinimum", scan.least.x) +
                number("xMaximum", scan.most.x) + number("yMinimum", scan.least.y) +
                number("yMaximum", scan.most.y) + number("zMinimum", scan.least.z) +
                number("zMaximum", scan.most.z) + "</cartesianBounds>\n";
    }
    return text;
}

std::string index_bounds(const E57ScanLayout& scan) {
    if (!scan.grid || scan.indices.empty()) return "";
    return fmt::format(
        "<indexBounds type=\"Structure\">\n"
        "<rowMinimum type=\"Integer\">{}</rowMinimum>\n"
        "<rowMaximum type=\"Integer\">{}</rowMaximum>\n"
        "<columnMinimum type=\"Integer\">{}</columnMinimum>\n"
        "<columnMaximum type=\"Integer\">{}</columnMaximum>\n</indexBounds>\n",
        scan.first_cell.row, scan.last_cell.row, scan.first_cell.column, scan.last_cell.column);
}

std::string pose(const Station& station) {
    return "<pose type=\"Structure\">\n<rotation type=\"Structure\">\n" +
           number("w", station.rotation[3]) + number("x", station.rotation[0]) +
           number("y", station.rotation[1]) + number("z", station.rotation[2]) +
           "</rotation>\n<translation type=\"Structure\">\n" + number("x", station.position.x) +
           number("y", station.position.y) + number("z", station.position.z) +
           "</translation>\n</pose>\n";
}

}  // namespace

std::string e57_description(std::span<const E57ScanLayout> scans, std::uint64_t content_hash) {
    std::string xml = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<e57Root type=\"Structure\" xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\""
        " xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\">\n"
        "<formatName type=\"String\">ASTM E57 3D Imaging Data File</formatName>\n"
        "<guid type=\"String\">{}</guid>\n"
        "<versionMajor type=\"Integer\">1</versionMajor>\n"
        "<versionMinor type=\"Integer\">0</versionMinor>\n"
        "<e57LibraryVersion type=\"String\">Glowworm {}</e57LibraryVersion>\n"
        "<coordinateMetadata type=\"String\"/>\n"
        "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n",
        guid(content_hash, 0), GLOWWORM_VERSION);
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const E57ScanLayout& scan = scans[i];
        xml += fmt::format(
            "<vectorChild type=\"Structure\">\n<guid type=\"String\">{}</guid>\n"
            "<name type=\"String\">{}</name>\n",
            guid(content_hash, i + 1), escaped(scan.station.name));
        xml += pose(scan.station) + limits(scan) + index_bounds(scan);
        xml += fmt::format(
            "<points type=\"CompressedVector\" fileOffset=\"{}\" recordCount=\"{}\">\n"
            "<prototype type=\"Structure\">\n{}</prototype>\n"
            "<codecs type=\"Vector\" "
            "allowHeterogeneousChildren=\"1\"/>\n</points>\n</vectorChild>\n",
            e57_physical(scan.section), scan.indices.size(), prototype(scan));
    }
    return xml +
           "</data3D>\n<images2D type=\"Vector\" allowHeterogeneousChildren=\"1\"/>\n</e57Root>\n";
}

}  // namespace glowworm

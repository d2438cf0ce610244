#include "preprocess/read/cloud_comments.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <span>

#include "preprocess/read/line_reader.h"

namespace glowworm {
namespace {

/// rply, and with it many programs, refuses header lines beyond 1024 characters.
constexpr std::size_t kLongestName = 600;

std::string escaped(std::string_view name) {
    std::string text;
    for (std::size_t i = 0; i < name.size() && text.size() < kLongestName; ++i) {
        const auto c = static_cast<unsigned char>(name[i]);
        const bool end_space = c == ' ' && (i == 0 || i + 1 == name.size());
        if (c < 0x20 || c == 0x7f || c == '%' || end_space) {
            text += fmt::format("%{:02X}", c);
        } else {
            text += name[i];
        }
    }
    return text;
}

std::string unescaped(std::string_view text) {
    std::string name;
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned value = 0;
        const char* hex = text.data() + i + 1;
        if (text[i] == '%' && i + 2 < text.size() &&
            std::from_chars(hex, hex + 2, value, 16).ptr == hex + 2) {
            name += static_cast<char>(value);
            i += 2;
        } else {
            name += text[i];
        }
    }
    return name;
}

bool take_numbers(std::string_view& line, std::span<double> numbers) {
    for (double& number : numbers) {
        if (!parse_number(take_word(line), number) || !std::isfinite(number)) return false;
    }
    return true;
}

std::string rest_as_name(std::string_view line) {
    if (!line.empty()) line.remove_prefix(1);
    return unescaped(line);
}

bool read_station(std::string_view line, std::vector<Station>& stations) {
    std::uint64_t index = 0;
    double numbers[8];
    if (!parse_count(take_word(line), index) || index != stations.size()) return false;
    if (!take_numbers(line, numbers)) return false;
    stations.push_back({.position = {numbers[0], numbers[1], numbers[2]},
                        .rotation = {numbers[3], numbers[4], numbers[5], numbers[6]},
                        .has_viewpoint = numbers[7] != 0.0,
                        .name = rest_as_name(line)});
    return true;
}

bool read_area_light(std::string_view line, std::vector<AreaLight>& lights) {
    double numbers[15];
    if (!take_numbers(line, numbers)) return false;
    AreaLight light;
    for (int corner = 0; corner < 4; ++corner) {
        const double* at = numbers + 3 * corner;
        light.corners[corner] = {at[0], at[1], at[2]};
    }
    light.radiance = vec3_cast<float>(Vec3d{numbers[12], numbers[13], numbers[14]});
    light.name = rest_as_name(line);
    lights.push_back(std::move(light));
    return true;
}

}  // namespace

std::vector<std::string> write_cloud_comments(const CloudComments& comments) {
    std::vector<std::string> lines;
    const Vec3d& o = comments.origin;
    lines.push_back(fmt::format("origin {} {} {}", o.x, o.y, o.z));
    for (std::size_t i = 0; i < comments.stations.size(); ++i) {
        const Station& s = comments.stations[i];
        const double* q = s.rotation;
        lines.push_back(fmt::format("station {} {} {} {} {} {} {} {} {} {}", i, s.position.x,
                                    s.position.y, s.position.z, q[0], q[1], q[2], q[3],
                                    s.has_viewpoint ? 1 : 0, escaped(s.name)));
    }
    for (const AreaLight& light : comments.area_lights) {
        std::string line = "area_light";
        for (const Vec3d& c : light.corners)
            line += fmt::format(" {} {} {}", c.x, c.y, c.z);
        const Vec3f& l = light.radiance;
        lines.push_back(line + fmt::format(" {} {} {} {}", l.x, l.y, l.z, escaped(light.name)));
    }
    return lines;
}

bool read_cloud_comment(std::string_view line, CloudComments& comments) {
    const std::string_view kind = take_word(line);
    if (kind == "station") return read_station(line, comments.stations);
    if (kind == "area_light") return read_area_light(line, comments.area_lights);
    double numbers[3];
    if (kind != "origin" || !take_numbers(line, numbers)) return false;
    comments.origin = {numbers[0], numbers[1], numbers[2]};
    return true;
}

void read_cloud_comments(std::span<const std::string> comments, ScanHeader& header) {
    CloudComments read;
    for (const std::string& comment : comments) {
        if (!read_cloud_comment(comment, read)) header.metadata.emplace_back("comment", comment);
    }
    header.origin = read.origin;
    header.stations = std::move(read.stations);
    header.area_lights = std::move(read.area_lights);
}

}  // namespace glowworm

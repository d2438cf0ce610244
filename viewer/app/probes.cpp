#include "viewer/app/probes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>

#include "octree/error.h"
#include "octree/output_path.h"

namespace glowworm {
namespace {

constexpr std::array<const char*, 6> kPlaceColumns = {"px", "py", "pz", "nx", "ny", "nz"};
constexpr std::array<const char*, 6> kResultColumns = {
    "E_direct_r", "E_direct_g", "E_direct_b", "E_indirect_r", "E_indirect_g", "E_indirect_b"};
/// Truth below this share of the mean is compared with this share: dark probes do not dominate.
constexpr double kDarkShare = 0.02;

/// The cells of a line, as they are written; a comma inside quotes does not separate.
std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (c == ',' && !quoted) {
            cells.emplace_back();
        } else {
            cells.back() += c;
        }
    }
    return cells;
}

bool read_line(std::istream& stream, std::string& line) {
    if (!std::getline(stream, line)) return false;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
}

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Where each of `names` stands in `header`; -1 where it does not.
std::array<std::ptrdiff_t, 6> places_of(const std::array<const char*, 6>& names,
                                        const std::vector<std::string>& header) {
    std::array<std::ptrdiff_t, 6> places{};
    for (std::size_t i = 0; i < 6; ++i) {
        const auto found = std::find(header.begin(), header.end(), names[i]);
        places[i] = found == header.end() ? -1 : found - header.begin();
    }
    return places;
}

std::array<double, 6> numbers_at(const std::array<std::ptrdiff_t, 6>& places,
                                 const std::vector<std::string>& cells, const std::string& where) {
    std::array<double, 6> numbers{};
    for (std::size_t i = 0; i < 6; ++i) {
        const std::string cell = trimmed(cells[static_cast<std::size_t>(places[i])]);
        const auto [end, error] =
            std::from_chars(cell.data(), cell.data() + cell.size(), numbers[i]);
        if (error != std::errc() || end != cell.data() + cell.size() ||
            !std::isfinite(numbers[i])) {
            throw Error(ExitCode::kUnreadable,
                        fmt::format("{}: '{}' is not a finite number", where, cell));
        }
    }
    return numbers;
}

std::string joined(const std::vector<std::string>& cells, const std::vector<bool>& keep) {
    std::string line;
    bool first = true;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (!keep[i]) continue;
        if (!first) line += ',';
        line += cells[i];
        first = false;
    }
    return line;
}

Vec3f to_float(const std::array<double, 6>& numbers, std::size_t first) {
    return vec3_cast<float>(Vec3d{numbers[first], numbers[first + 1], numbers[first + 2]});
}

template <typename Pick>
Difference difference_of(std::span<const Irradiance> truth, std::span<const Irradiance> measured,
                         Pick pick) {
    double sum = 0;
    for (const Irradiance& t : truth) {
        for (int c = 0; c < 3; ++c)
            sum += pick(t)[c];
    }
    const double channels = 3.0 * static_cast<double>(truth.size());
    const double dark = std::max(kDarkShare * sum / channels, 1e-12);
    Difference difference;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double t = pick(truth[i])[c], m = pick(measured[i])[c];
            const double relative = std::abs(m - t) / std::max(t, dark);
            difference.mean += relative / channels;
            difference.worst = std::max(difference.worst, relative);
        }
    }
    return difference;
}

}  // namespace

ProbeTable read_probes(const std::filesystem::path& path) {
    require_regular_input(path);
    std::ifstream stream(path);
    std::string line;
    if (!stream || std::filesystem::is_directory(path)) {
        throw Error(ExitCode::kUnreadable,
                    fmt::format("cannot read the probes '{}'", path.string()));
    }
    if (!read_line(stream, line)) {
        throw Error(ExitCode::kDegenerate, fmt::format("'{}' is empty", path.string()));
    }
    if (line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);  // a byte order mark

    std::vector<std::string> header = split(line);
    for (std::string& name : header)
        name = trimmed(name);
    const auto place_columns = places_of(kPlaceColumns, header);
    const auto truth_columns = places_of(kResultColumns, header);
    for (std::size_t i = 0; i < 6; ++i) {
        if (place_columns[i] < 0) {
            throw Error(ExitCode::kUnreadable,
                        fmt::format("'{}' has no column '{}': probes need px,py,pz,nx,ny,nz",
                                    path.string(), kPlaceColumns[i]));
        }
    }
    for (auto name = header.begin(); name != header.end(); ++name) {
        const auto named = [&](const char* known) { return *name == known; };
        if (std::find(name + 1, header.end(), *name) != header.end() &&
            (std::ranges::any_of(kPlaceColumns, named) ||
             std::ranges::any_of(kResultColumns, named))) {
            throw Error(ExitCode::kUnreadable,
                        fmt::format("'{}' has two columns '{}': keep one", path.string(), *name));
        }
    }
    std::vector<bool> keep(header.size(), true);
    for (const std::ptrdiff_t column : truth_columns) {
        if (column >= 0) keep[static_cast<std::size_t>(column)] = false;
    }
    const bool has_truth = std::all_of(truth_columns.begin(), truth_columns.end(),
                                       [](std::ptrdiff_t column) { return column >= 0; });

    ProbeTable table;
    table.carried_header = joined(header, keep);
    for (std::size_t number = 2; read_line(stream, line); ++number) {
        if (trimmed(line).empty()) continue;
        const std::vector<std::string> cells = split(line);
        const std::string where = fmt::format("'{}' line {}", path.string(), number);
        if (cells.size() != header.size()) {
            throw Error(ExitCode::kUnreadable, fmt::format("{} has {} cells, the header {}", where,
                                                           cells.size(), header.size()));
        }
        const auto place = numbers_at(place_columns, cells, where);
        const Vec3d normal{place[3], place[4], place[5]};
        if (!(length(normal) > 0)) {
            throw Error(ExitCode::kUnreadable, where + ": the normal is zero");
        }
        table.probes.push_back({{place[0], place[1], place[2]}, normalized(normal)});
        table.carried.push_back(joined(cells, keep));
        if (has_truth) {
            const auto truth = numbers_at(truth_columns, cells, where);
            table.truth.push_back({to_float(truth, 0), to_float(truth, 3)});
        }
    }
    if (table.probes.empty()) {
        throw Error(ExitCode::kDegenerate, fmt::format("'{}' has no probes", path.string()));
    }
    return table;
}

std::string format_probes(const ProbeTable& table, std::span<const Irradiance> measured) {
    std::string text = table.carried_header;
    for (const char* name : kResultColumns)
        text += fmt::format(",{}", name);
    text += '\n';
    for (std::size_t i = 0; i < measured.size(); ++i) {
        const Irradiance& e = measured[i];
        text += fmt::format("{},{},{},{},{},{},{}\n", table.carried[i], e.direct.x, e.direct.y,
                            e.direct.z, e.indirect.x, e.indirect.y, e.indirect.z);
    }
    return text;
}

std::optional<ProbeDifferences> compare_probes(const ProbeTable& table,
                                               std::span<const Irradiance> measured) {
    if (table.truth.empty()) return std::nullopt;
    return ProbeDifferences{
        difference_of(table.truth, measured, [](const Irradiance& e) { return e.direct; }),
        difference_of(table.truth, measured, [](const Irradiance& e) { return e.indirect; })};
}

}  // namespace glowworm

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "preprocess/read/line_reader.h"
#include "preprocess/read/table.h"

namespace glowworm {
namespace {

constexpr std::size_t kMostSampled = 500;
constexpr std::size_t kMostColumns = 256;
constexpr const char* kHowToName = "say what its columns mean with --columns \"x y z intensity\"";

bool is_comment(std::string_view line) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return true;
    line.remove_prefix(begin);
    return line.starts_with('#') || line.starts_with("//") || line.starts_with('%');
}

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
    std::vector<std::string_view> cells;
    if (delimiter == ' ') {
        for (auto word = take_word(line); !word.empty(); word = take_word(line))
            cells.push_back(word);
        return cells;
    }
    for (std::size_t end = 0; end != std::string_view::npos && cells.size() <= kMostColumns;) {
        end = line.find(delimiter);
        cells.push_back(line.substr(0, end));
        if (end != std::string_view::npos) line.remove_prefix(end + 1);
    }
    // A delimiter at the end of the line parts nothing.
    if (cells.size() > 1 && cells.back().find_first_not_of(" \t") == std::string_view::npos) {
        cells.pop_back();
    }
    return cells;
}

/// A way to read the lines, and the numbers it finds in them, [rows][columns].
struct Reading {
    TableShape shape;
    std::size_t first_row = 0;  // index among the head's lines
    std::vector<std::vector<double>> rows;
    double number_share = 0.0;  // of the cells
};

/// Tries a delimiter and a decimal sign. None unless at least 9 of 10 lines have the same number of
/// cells, three or more of them numbers.
std::optional<Reading> try_reading(const TextHead& head, char delimiter, bool decimal_comma) {
    Reading reading;
    reading.shape.delimiter = delimiter;
    reading.shape.decimal_comma = decimal_comma;
    std::string scratch;
    std::size_t columns = 0, sampled = 0, fitting = 0, most_numbers = 0, numbers_found = 0;
    for (std::size_t i = 0; i < head.lines.size() && sampled < kMostSampled; ++i) {
        const std::string_view line = head.lines[i];
        if (is_comment(line)) continue;
        const std::size_t cells = std::min(cells_of(line, delimiter).size(), kMostColumns);
        reading.shape.columns.assign(cells, Column::kNone);
        std::vector<double> values(cells);
        const std::size_t numbers = parse_cells(line, reading.shape, values, scratch);
        if (sampled == 0 && numbers < 3) {
            if (i + 1 - reading.first_row > 20) return std::nullopt;
            continue;  // names, or a title
        }
        if (sampled++ == 0) {
            columns = cells;
            most_numbers = numbers;
            reading.first_row = i;
        }
        if (cells != columns || numbers < std::min<std::size_t>(most_numbers, 3)) continue;
        ++fitting;
        numbers_found += numbers;
        reading.rows.push_back(std::move(values));
    }
    reading.shape.columns.assign(columns, Column::kNone);
    if (sampled == 0 || fitting * 10 < sampled * 9) return std::nullopt;
    reading.number_share =
        static_cast<double>(numbers_found) / static_cast<double>(fitting * columns);
    return reading;
}

/// Rows that are matrices of poses and not points: every fourth one is 0 0 0 1.
bool are_matrices(const std::vector<std::vector<double>>& rows) {
    if (rows.size() % 4 != 0) return false;
    for (std::size_t i = 3; i < rows.size(); i += 4) {
        if (rows[i] != std::vector<double>{0, 0, 0, 1}) return false;
    }
    return true;
}

bool are_unit_vectors(const std::vector<std::vector<double>>& rows, std::size_t column) {
    std::size_t unit = 0;
    for (const auto& row : rows) {
        const double l = std::hypot(row[column], row[column + 1], row[column + 2]);
        unit += std::abs(l - 1.0) < 0.02;
    }
    return unit * 20 >= rows.size() * 19;
}

bool are_bytes(const std::vector<std::vector<double>>& rows, std::size_t column) {
    return std::ranges::all_of(rows, [column](const auto& row) {
        const double v = row[column];
        return v >= 0.0 && v <= 255.0 && v == std::floor(v);
    });
}

bool set_three(std::vector<Column>& columns, std::size_t at, Column first) {
    for (std::size_t k = 0; k < 3; ++k) {
        columns[at + k] = static_cast<Column>(static_cast<std::size_t>(first) + k);
    }
    return true;
}

void guess_columns(Reading& reading) {
    std::vector<Column>& columns = reading.shape.columns;
    set_three(columns, 0, Column::kX);
    bool normal = false, colour = false;
    const auto is_free = [&](std::size_t at) {
        return std::all_of(columns.begin() + static_cast<std::ptrdiff_t>(at),
                           columns.begin() + static_cast<std::ptrdiff_t>(at + 3),
                           [](Column c) { return c == Column::kNone; });
    };
    for (std::size_t at = 3; at + 3 <= columns.size() && !normal; ++at) {
        if (are_unit_vectors(reading.rows, at)) normal = set_three(columns, at, Column::kNormalX);
    }
    // From the end: where intensity is whole and small too it comes first, as in PTS.
    for (std::size_t at = columns.size(); at-- > 3 && !colour;) {
        if (at + 3 > columns.size() || !is_free(at)) continue;
        if (are_bytes(reading.rows, at) && are_bytes(reading.rows, at + 1) &&
            are_bytes(reading.rows, at + 2)) {
            colour = set_three(columns, at, Column::kRed);
        }
    }
    const auto left = std::ranges::find(columns, Column::kNone);
    if (left != columns.end()) *left = Column::kIntensity;
}

/// The line of names just before the first row, if there is one.
std::vector<Column> columns_in_header(const TextHead& head, const Reading& reading, bool& named) {
    std::vector<Column> columns;
    named = false;
    for (std::size_t i = reading.first_row; i-- > 0 && !named;) {
        std::string_view line = head.lines[i];
        const std::size_t begin = line.find_first_not_of(" \t#/%");
        if (begin == std::string_view::npos) continue;
        line.remove_prefix(begin);
        columns.clear();
        for (const std::string_view cell : cells_of(line, reading.shape.delimiter)) {
            columns.push_back(column_named(cell));
            named |= columns.back() != Column::kNone;
        }
        if (!is_comment(head.lines[i])) break;  // the nearest line that is no comment decides
    }
    return columns;
}

std::string names_of(const std::vector<Column>& columns) {
    std::string names;
    for (const Column column : columns) {
        names += names.empty() ? "" : " ";
        names += column == Column::kNone ? "-" : column_name(column);
    }
    return names;
}

}  // namespace

bool has_positions(const std::vector<Column>& columns) {
    return std::ranges::all_of(std::vector{Column::kX, Column::kY, Column::kZ}, [&](Column c) {
        return std::ranges::find(columns, c) != columns.end();
    });
}

std::vector<Column> columns_given(const std::string& words, std::size_t count) {
    std::vector<Column> columns;
    std::string_view left = words;
    for (auto word = take_word(left, " ,;\t"); !word.empty() && columns.size() < count;
         word = take_word(left, " ,;\t")) {
        columns.push_back(column_named(word));
    }
    columns.resize(count, Column::kNone);
    return columns;
}

std::string delimiter_name(const TableShape& shape) {
    std::string name = shape.delimiter == ' '    ? "spaces"
                       : shape.delimiter == '\t' ? "tabs"
                                                 : fmt::format("'{}'", shape.delimiter);
    return name + (shape.decimal_comma ? ", with decimal commas" : "");
}

bool work_out_table(const TextHead& head, char delimiter, const std::string& columns,
                    TableShape& shape) {
    struct Attempt {
        char delimiter;
        bool decimal_comma;
    };
    constexpr Attempt kAttempts[] = {{';', false}, {';', true},  {'\t', false}, {'\t', true},
                                     {',', false}, {' ', false}, {' ', true}};
    std::optional<Reading> reading;
    for (const Attempt& attempt : kAttempts) {
        if (delimiter != '\0' && delimiter != attempt.delimiter) continue;
        std::optional<Reading> tried = try_reading(head, attempt.delimiter, attempt.decimal_comma);
        if (tried && (!reading || tried->number_share > reading->number_share)) {
            reading = std::move(tried);
        }
    }
    if (!reading && delimiter != '\0') reading = try_reading(head, delimiter, false);
    if (!reading) {
        shape.described =
            "its lines are no table of points; export the scan as E57, LAS, PLY or PCD, or say what "
            "parts its columns with --delimiter";
        return false;
    }
    std::string source = "worked out from the values";
    if (!columns.empty()) {
        reading->shape.columns = columns_given(columns, reading->shape.columns.size());
        source = "as given";
    } else {
        bool named = false;
        std::vector<Column> header = columns_in_header(head, *reading, named);
        if (named) {
            header.resize(reading->shape.columns.size(), Column::kNone);
            reading->shape.columns = std::move(header);
            source = "named by its header";
        } else if (are_matrices(reading->rows)) {
            shape.described = "its lines are matrices, not points; name a scan file";
            return false;
        } else if (reading->first_row > 0 && !is_comment(head.lines[reading->first_row - 1])) {
            shape.described =
                fmt::format("its header '{}' names no x, y and z; {}",
                            head.lines[reading->first_row - 1].substr(0, 80), kHowToName);
            return false;
        } else {
            const auto& first = reading->rows.front();
            if (std::isnan(first[0]) || std::isnan(first[1]) || std::isnan(first[2])) {
                shape.described =
                    fmt::format("its lines do not begin with three numbers; {}", kHowToName);
                return false;
            }
            guess_columns(*reading);
        }
    }
    if (!has_positions(reading->shape.columns)) {
        shape.described = fmt::format("its columns, {}, are '{}' and lack one of x, y and z; {}",
                                      source, names_of(reading->shape.columns), kHowToName);
        return false;
    }
    shape = std::move(reading->shape);
    shape.header_lines = reading->first_row;
    for (std::size_t i = 0; i < shape.columns.size(); ++i) {
        if (shape.columns[i] < Column::kRed || shape.columns[i] > Column::kBlue) continue;
        for (const auto& row : reading->rows) {
            shape.integer_colours &= std::isnan(row[i]) || row[i] == std::floor(row[i]);
        }
    }
    shape.described =
        fmt::format("Its {} columns are parted by {} and are, {}: {}.", shape.columns.size(),
                    delimiter_name(shape), source, names_of(shape.columns));
    return true;
}

}  // namespace glowworm

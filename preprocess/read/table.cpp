#include "preprocess/read/table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "preprocess/read/line_reader.h"
#include "preprocess/read/registry.h"

namespace glowworm {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

std::string_view trimmed(std::string_view cell) {
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t' || cell.front() == '"')) {
        cell.remove_prefix(1);
    }
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t' || cell.back() == '"')) {
        cell.remove_suffix(1);
    }
    return cell;
}

double number_in(std::string_view cell) {
    double value = 0.0;
    return parse_number(trimmed(cell), value) ? value : kNoNumber;
}

/// Numbers parted by spaces and tabs, the case that must be fast.
std::size_t parse_spaced(std::string_view line, std::span<double> values) {
    const char* at = line.data();
    const char* const end = at + line.size();
    std::size_t numbers = 0;
    for (double& value : values) {
        while (at < end && (*at == ' ' || *at == '\t'))
            ++at;
        const char* const stop = parse_number(at, end, value);
        const bool whole = stop != at && (stop == end || *stop == ' ' || *stop == '\t');
        if (whole) {
            at = stop;
            ++numbers;
            continue;
        }
        const char* const begin = at;
        while (at < end && *at != ' ' && *at != '\t')
            ++at;
        value = number_in({begin, static_cast<std::size_t>(at - begin)});
        if (!std::isnan(value)) ++numbers;
    }
    return numbers;
}

}  // namespace

bool read_text_head(std::span<const std::byte> bytes, TextHead& head) {
    const std::string_view raw(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::size_t mark = 0;
    const TextEncoding encoding = text_encoding(raw, mark);
    if (encoding == TextEncoding::kUtf8) {
        head.text = raw.substr(mark);
    } else {
        std::vector<char> text;
        append_utf16(raw.substr(mark), encoding, text);
        head.text.assign(text.begin(), text.end());
    }
    for (const char c : head.text) {
        if (c >= 0 && c < ' ' && c != '\n' && c != '\r' && c != '\t') return false;
    }
    const char terminator = head.text.find('\n') == std::string::npos ? '\r' : '\n';
    const bool whole = bytes.size() < kHeadBytes;
    std::string_view left = head.text;
    while (!left.empty()) {
        const std::size_t end = left.find(terminator);
        if (end == std::string_view::npos && !whole && !head.lines.empty()) break;
        std::string_view line = left.substr(0, end);
        left.remove_prefix(std::min(left.size(), line.size() + 1));
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        head.lines.push_back(line);
    }
    return true;
}

std::size_t count_numbers(std::string_view line) {
    std::size_t count = 0;
    double value = 0.0;
    for (auto word = take_word(line); !word.empty(); word = take_word(line), ++count) {
        if (!parse_number(word, value)) return 0;
    }
    return count;
}

std::size_t parse_cells(std::string_view line, const TableShape& shape, std::span<double> values,
                        std::string& scratch) {
    if (shape.decimal_comma) {
        scratch = line;
        std::ranges::replace(scratch, ',', '.');
        line = scratch;
    }
    if (shape.delimiter == ' ') return parse_spaced(line, values);
    std::size_t numbers = 0;
    const char* at = line.data();
    const char* const end = at + line.size();
    for (double& value : values) {
        const char* const stop = at < end ? parse_number(at, end, value) : at;
        if (stop != at && (stop == end || *stop == shape.delimiter)) {
            ++numbers;
            at = stop < end ? stop + 1 : end;
            continue;
        }
        const char* const begin = at;
        while (at < end && *at != shape.delimiter)
            ++at;
        value = number_in({begin, static_cast<std::size_t>(at - begin)});
        if (!std::isnan(value)) ++numbers;
        if (at < end) ++at;
    }
    return numbers;
}

RecordLayout layout_of(const TableShape& shape) {
    RecordLayout layout;
    const std::size_t stride = shape.columns.size() * sizeof(double);
    for (std::size_t i = 0; i < shape.columns.size(); ++i) {
        const Column column = shape.columns[i];
        if (column == Column::kNone ||
            std::ranges::find(layout.fields, column, &RecordField::column) != layout.fields.end()) {
            continue;
        }
        const bool colour =
            column == Column::kRed || column == Column::kGreen || column == Column::kBlue;
        layout.fields.push_back(
            {column, colour && shape.integer_colours ? ScalarType::kU16 : ScalarType::kF64,
             ScalarType::kF64, i * sizeof(double), stride});
    }
    return layout;
}

}  // namespace glowworm

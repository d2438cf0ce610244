#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "preprocess/read/columns.h"
#include "preprocess/read/records.h"

namespace glowworm {

/// How a text file holds one point per line.
struct TableShape {
    char delimiter = ' ';         ///< ' ' is any number of spaces and tabs
    bool decimal_comma = false;   ///< "1,5" is one and a half
    std::vector<Column> columns;  ///< what each column means
    bool integer_colours = true;  ///< no colour is written with a decimal point
    std::size_t header_lines =
        0;                  ///< comments, blank lines and column names before the first point
    std::string described;  ///< one sentence: what was worked out, and from what
};

/// The first lines of a text file.
struct TextHead {
    std::string text;
    std::vector<std::string_view> lines;  ///< views of `text`; a last line that is cut is left out
    TextHead() = default;
    TextHead(const TextHead&) = delete;
    TextHead& operator=(const TextHead&) = delete;
};

/// Reads the lines of a file's first bytes into `head`. False where they are no text: a zero byte
/// or another control character.
bool read_text_head(std::span<const std::byte> bytes, TextHead& head);

/// Whether every cell of the line, parted by spaces or tabs, is a number, and how many there are.
std::size_t count_numbers(std::string_view line);

/// Parses the cells of a line into values[i], i < columns.size(); what is no number, and what is
/// missing, becomes NaN. `scratch` holds the line where its decimal commas are replaced.
/// Returns how many numbers there were.
std::size_t parse_cells(std::string_view line, const TableShape& shape, std::span<double> values,
                        std::string& scratch);

/// Works out delimiter, decimal sign, header and meaning of the columns from the first lines.
/// False where they are no table of points; `shape.described` then says why, as a clause.
/// `delimiter` and `columns` are ReadSettings': what they state is not worked out. Without a header
/// the first three columns are positions; after them three columns of unit vectors are a normal,
/// three of integers up to 255 a colour, and the first other one is intensity.
bool work_out_table(const TextHead& head, char delimiter, const std::string& columns,
                    TableShape& shape);

/// What ReadSettings::columns says of `count` columns: kNone for "-", for words that are not known
/// and for what is left.
std::vector<Column> columns_given(const std::string& words, std::size_t count);

/// Whether x, y and z are among them.
bool has_positions(const std::vector<Column>& columns);

/// "spaces", "','", "tabs, with decimal commas".
std::string delimiter_name(const TableShape& shape);

/// Records of one double per column.
RecordLayout layout_of(const TableShape& shape);

}  // namespace glowworm

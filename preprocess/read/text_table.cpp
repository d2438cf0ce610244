#include "preprocess/read/text_table.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "preprocess/read/line_reader.h"
#include "preprocess/read/registry.h"
#include "preprocess/read/table.h"

namespace glowworm {
namespace {

constexpr std::size_t kBlockValues = std::size_t{1} << 19;  // doubles, 4 MiB
constexpr std::size_t kBlockPoints = 65536;

/// PTS columns by how many there are.
std::vector<Column> pts_columns(std::size_t count) {
    using enum Column;
    std::vector<Column> columns = {kX,     kY,    kZ,       kIntensity, kRed,
                                   kGreen, kBlue, kNormalX, kNormalY,   kNormalZ};
    if (count == 6 || count == 9) columns.erase(columns.begin() + 3);
    columns.resize(count, kNone);
    return columns;
}

class TextTable final : public ScanFile {
  public:
    TextTable(InputFile file, TableShape shape, bool counted)
        : file_(std::move(file)),
          lines_(file_),
          shape_(std::move(shape)),
          layout_(layout_of(shape_)),
          counted_(counted) {
        // Three numbers and what parts them take at least six bytes of the file.
        const std::size_t rows = std::min({kBlockPoints, kBlockValues / shape_.columns.size(),
                                           static_cast<std::size_t>(file_.size() / 6 + 1)});
        values_.resize(rows * shape_.columns.size());
    }

    Format format() const override {
        return {counted_ ? "PTS" : "text table", "parted by " + delimiter_name(shape_)};
    }

    bool next_scan(ScanHeader& header) override {
        PointBlock rest;
        while (!at_end_ && begun_ && next_block(rest)) {
        }
        if (!begin_scan()) return false;
        header = {};
        header.declared_points = announced_;
        read_rows();
        choose_colour_factor(layout_, as_bytes(), rows_);
        header.columns = columns_of(layout_);
        header.colour_bits = colour_bits(layout_);
        for (std::size_t i = 0; i < shape_.columns.size(); ++i) {
            header.fields.push_back({fmt::format("column {}", i + 1), "text",
                                     std::string(column_name(shape_.columns[i]))});
        }
        if (!counted_) header.notes.push_back(shape_.described);
        return true;
    }

    bool next_block(PointBlock& block) override {
        if (rows_ == 0) read_rows();
        if (rows_ == 0 && invalid_ == 0) {
            block.resize(0, {});
            return false;
        }
        block.resize(rows_, columns_of(layout_));
        block.invalid = std::exchange(invalid_, 0);
        decode_records(layout_, as_bytes(), std::exchange(rows_, 0), 0, block);
        return true;
    }

  private:
    const std::byte* as_bytes() const { return reinterpret_cast<const std::byte*>(values_.data()); }

    /// Passes over header lines; with a count, reads it or takes the one that ended the last scan.
    bool begin_scan() {
        scan_ended_ = false;
        if (!counted_) return !std::exchange(begun_, true) && pass_header();
        if (begun_) return std::exchange(next_announced_, false);
        begun_ = true;
        std::string_view line;
        while (lines_.next(line)) {
            if (parse_count(take_word(line), announced_)) return true;
        }
        return false;
    }

    bool pass_header() {
        std::string_view line;
        for (std::size_t i = 0; i < shape_.header_lines; ++i)
            lines_.next(line);
        return true;
    }

    /// Reads lines until values_ is full, the file ends, or a count announces another cloud.
    void read_rows() {
        const std::size_t columns = shape_.columns.size();
        std::string_view line;
        while (!scan_ended_ && (rows_ + 1) * columns <= values_.size()) {
            if (!lines_.next(line)) {
                scan_ended_ = at_end_ = true;
                return;
            }
            const std::span<double> row(&values_[rows_ * columns], columns);
            const std::size_t numbers = parse_cells(line, shape_, row, scratch_);
            if (numbers >= 3) {
                ++rows_;
            } else if (std::uint64_t count = 0; counted_ && numbers == 1 &&
                                                count_numbers(line) == 1 &&
                                                parse_count(take_word(line), count)) {
                announced_ = count;
                next_announced_ = scan_ended_ = true;
            } else if (line.find_first_not_of(" \t") != std::string_view::npos && line[0] != '#' &&
                       !line.starts_with("//")) {
                ++invalid_;
            }
        }
    }

    InputFile file_;
    LineReader lines_;
    TableShape shape_;
    RecordLayout layout_;
    bool counted_;  // PTS
    bool begun_ = false, at_end_ = false, scan_ended_ = false, next_announced_ = false;
    std::uint64_t announced_ = 0;
    std::vector<double> values_;  // [rows_][columns]
    std::size_t rows_ = 0;        // read and not yet handed out
    std::uint64_t invalid_ = 0;
    std::string scratch_;
};

std::vector<std::byte> head_bytes(const InputFile& file) {
    std::vector<std::byte> head(kHeadBytes);
    head.resize(file.read_some(0, head.data(), head.size()));
    return head;
}

}  // namespace

bool is_pts(std::span<const std::byte> bytes) {
    TextHead head;
    if (!read_text_head(bytes, head) || head.lines.size() < 2) return false;
    std::string_view first = head.lines[0];
    std::uint64_t count = 0;
    if (count_numbers(first) != 1 || !parse_count(take_word(first), count)) return false;
    return count_numbers(head.lines[1]) >= 3;
}

std::unique_ptr<ScanFile> open_pts(InputFile file, const ReadSettings& settings) {
    TextHead head;
    const bool text = read_text_head(head_bytes(file), head) && head.lines.size() > 1;
    const std::size_t columns = text ? count_numbers(head.lines[1]) : 0;
    if (columns < 3) file.fail("its second line does not begin with x y z; export it again as PTS");
    TableShape shape;
    shape.columns = pts_columns(std::min<std::size_t>(columns, 64));
    if (!settings.columns.empty()) {
        shape.columns = columns_given(settings.columns, shape.columns.size());
        if (!has_positions(shape.columns)) {
            file.fail("--columns '" + settings.columns + "' lacks one of x, y and z");
        }
    }
    return std::make_unique<TextTable>(std::move(file), std::move(shape), true);
}

bool is_text_table(std::span<const std::byte> bytes) {
    TextHead head;
    TableShape shape;
    return read_text_head(bytes, head) && work_out_table(head, '\0', "", shape);
}

std::unique_ptr<ScanFile> open_text_table(InputFile file, const ReadSettings& settings) {
    TextHead head;
    TableShape shape;
    if (!read_text_head(head_bytes(file), head))
        file.fail("it is no text; leave out what its columns mean");
    if (!work_out_table(head, settings.delimiter, settings.columns, shape)) {
        file.fail(shape.described +
                  "; say what the columns mean with --columns \"x y z intensity\"");
    }
    return std::make_unique<TextTable>(std::move(file), std::move(shape), false);
}

std::string why_no_text_table(std::span<const std::byte> bytes) {
    TextHead head;
    TableShape shape;
    if (!read_text_head(bytes, head) || work_out_table(head, '\0', "", shape)) return "";
    return shape.described;
}

}  // namespace glowworm

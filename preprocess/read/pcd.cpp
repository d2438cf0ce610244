#include "preprocess/read/pcd.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <utility>

#include "preprocess/read/byte_reader.h"
#include "preprocess/read/cloud_comments.h"
#include "preprocess/read/line_reader.h"
#include "preprocess/read/lzf.h"
#include "preprocess/read/pcd_header.h"

namespace glowworm {
namespace {

constexpr std::size_t kBlockPoints = 65536;
constexpr std::size_t kBlockBytes = std::size_t{4} << 20;

/// Records one after the other, or, compressed, columns one after the other.
RecordLayout layout_of(const PcdHeader& header) {
    RecordLayout layout;
    const bool ascii = header.encoding == PcdEncoding::kAscii;
    const bool compressed = header.encoding == PcdEncoding::kBinaryCompressed;
    std::size_t offset = 0;
    for (const PcdField& field : header.fields) {
        const ScalarType stored = ascii ? ScalarType::kF64 : field.type;
        const std::size_t bytes = scalar_bytes(stored) * field.count;
        const Column column = field.count == 1 ? column_named(field.name) : Column::kNone;
        if (column != Column::kNone &&
            std::ranges::find(layout.fields, column, &RecordField::column) == layout.fields.end()) {
            layout.fields.push_back({column, field.type, stored, offset, bytes});
        }
        offset += compressed ? bytes * header.points : bytes;
    }
    if (!compressed) {
        for (RecordField& field : layout.fields)
            field.stride = offset;
    }
    return layout;
}

/// PCL prints packed colours either as the integer they are or as the float whose bits they are.
double packed_colour(std::string_view word, double value, ScalarType declared) {
    const bool integer = word.find_first_not_of("0123456789") == std::string_view::npos;
    if (declared != ScalarType::kF32 || integer) return value;
    return static_cast<double>(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

class PcdFile final : public ScanFile {
  public:
    explicit PcdFile(InputFile file)
        : file_(std::move(file)),
          header_(read_pcd_header(file_)),
          bytes_(file_, header_.data_offset) {}

    Format format() const override {
        constexpr const char* kEncodings[] = {"ascii", "binary", "binary_compressed"};
        return {"PCD", header_.version + " " + kEncodings[static_cast<int>(header_.encoding)]};
    }

    bool next_scan(ScanHeader& header) override {
        if (std::exchange(begun_, true)) {
            left_ = 0;
            return false;
        }
        header = {};
        read_cloud_comments(header_.comments, header);
        header.T_world_scan = header_.viewpoint;
        header.has_viewpoint = header_.viewpoint.has_value();
        if (header_.points == 0) return true;
        begin_points();
        header.declared_points = header_.points;
        header.columns = columns_of(layout_);
        header.colour_bits = colour_bits(layout_);
        for (const PcdField& field : header_.fields) {
            const Column column = field.count == 1 ? column_named(field.name) : Column::kNone;
            header.fields.push_back({field.name, std::string(scalar_name(field.type)),
                                     std::string(column_name(column))});
        }
        return true;
    }

    bool next_block(PointBlock& block) override {
        block.resize(0, {});
        if (left_ == 0) return false;
        if (records_left_ == 0) fill_records();
        const std::size_t count = std::min(records_left_, kBlockPoints);
        block.resize(count, columns_of(layout_));
        decode_records(layout_, records_.data(), count, 0, block);
        left_ -= count;
        records_left_ -= count;
        if (header_.encoding == PcdEncoding::kBinaryCompressed) {
            for (RecordField& field : layout_.fields)
                field.offset += count * field.stride;
        }
        return true;
    }

  private:
    void begin_points() {
        record_bytes_ = header_.record_bytes();
        const bool ascii = header_.encoding == PcdEncoding::kAscii;
        if (header_.encoding == PcdEncoding::kBinaryCompressed) {
            read_compressed();
        } else {
            std::size_t values = 0;
            for (const PcdField& field : header_.fields)
                values += field.count;
            // A digit and what parts it from the next; the last may lack an end of line.
            const std::uint64_t most =
                ascii ? (bytes_.left() + 1) / std::max<std::size_t>(1, 2 * values)
                      : bytes_.left() / std::max<std::size_t>(1, record_bytes_);
            check_count(most);
            if (ascii) record_bytes_ = values * sizeof(double);
        }
        layout_ = layout_of(header_);
        if (!has_positions(layout_)) {
            file_.fail("its points have no x, y and z; export it with positions");
        }
        if (ascii) lines_.emplace(file_, header_.data_offset);
        left_ = header_.points;
        if (records_left_ == 0) fill_records();
        choose_colour_factor(layout_, records_.data(), std::min(records_left_, kBlockPoints));
    }

    void check_count(std::uint64_t most) const {
        if (header_.points <= most) return;
        file_.fail(
            fmt::format("it announces {} points but holds at most {}; copy or export it again",
                        header_.points, most));
    }

    void read_compressed() {
        std::uint32_t sizes[2] = {};  // compressed, uncompressed
        bytes_.read(sizes, sizeof sizes);
        check_count(sizes[1] / std::max<std::size_t>(1, record_bytes_));
        if (sizes[0] > bytes_.left() || sizes[1] != header_.points * record_bytes_ ||
            sizes[1] / kLzfLargestExpansion > sizes[0]) {
            file_.fail("its compressed size does not fit its points; copy or export it again");
        }
        std::vector<std::byte> compressed(sizes[0]);
        bytes_.read(compressed.data(), compressed.size());
        records_.resize(sizes[1]);
        if (!decode_lzf(compressed, records_)) {
            file_.fail("its compressed points are damaged; copy or export it again");
        }
        records_left_ = header_.points;
    }

    /// Reads the next records, as many as make a block.
    void fill_records() {
        const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(
            left_, std::clamp<std::size_t>(kBlockBytes / record_bytes_, 1, kBlockPoints)));
        records_.resize(count * record_bytes_);
        if (lines_) {
            for (std::size_t i = 0; i < count; ++i)
                parse_record(&records_[i * record_bytes_]);
        } else {
            bytes_.read(records_.data(), records_.size());
        }
        records_left_ = count;
    }

    void parse_record(std::byte* into) {
        std::string_view line;
        do {
            if (!lines_->next(line)) {
                file_.fail("it ends before its header says it does; copy or export it again");
            }
        } while (line.find_first_not_of(" \t,;") == std::string_view::npos);
        for (const PcdField& field : header_.fields) {
            const bool packed = field.name == "rgb" || field.name == "rgba";
            for (std::size_t i = 0; i < field.count; ++i) {
                const std::string_view word = take_word(line, " \t,;");
                double value = 0.0;
                if (!parse_number(word, value)) {
                    file_.fail(
                        fmt::format("'{}' stands where a number should, at byte {}; export it "
                                    "again",
                                    word.substr(0, 40), lines_->offset()));
                }
                if (packed) value = packed_colour(word, value, field.type);
                std::memcpy(into, &value, sizeof value);
                into += sizeof value;
            }
        }
    }

    InputFile file_;
    PcdHeader header_;
    ByteReader bytes_;
    std::optional<LineReader> lines_;  // ascii
    bool begun_ = false;
    RecordLayout layout_;
    std::size_t record_bytes_ = 0;  // ascii: of the parsed record
    std::uint64_t left_ = 0;        // points not yet handed out
    std::vector<std::byte> records_;
    std::size_t records_left_ = 0;  // of records_, not yet handed out
};

}  // namespace

bool is_pcd(std::span<const std::byte> head) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    if (text.starts_with("# .PCD")) return true;
    return (text.starts_with("VERSION") || text.starts_with("FIELDS") || text.starts_with("#")) &&
           text.find("\nPOINTS ") != std::string_view::npos &&
           text.find("\nDATA ") != std::string_view::npos;
}

std::unique_ptr<ScanFile> open_pcd(InputFile file, const ReadSettings&) {
    return std::make_unique<PcdFile>(std::move(file));
}

}  // namespace glowworm

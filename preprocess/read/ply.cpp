#include "preprocess/read/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

#include "preprocess/read/byte_reader.h"
#include "preprocess/read/cloud_comments.h"
#include "preprocess/read/line_reader.h"
#include "preprocess/read/ply_header.h"

namespace glowworm {
namespace {

constexpr std::size_t kBlockPoints = 65536;
constexpr std::size_t kBlockBytes = std::size_t{4} << 20;

/// The element's records once its lists are left out. Ascii is parsed into doubles.
RecordLayout layout_of(const PlyElement& element, PlyEncoding encoding) {
    RecordLayout layout;
    layout.swapped = encoding == PlyEncoding::kBigEndian;
    std::size_t offset = 0;
    for (const PlyProperty& property : element.properties) {
        if (property.list_count_type) continue;
        const Column column = column_named(property.name);
        const ScalarType stored =
            encoding == PlyEncoding::kAscii ? ScalarType::kF64 : property.type;
        if (column != Column::kNone &&
            std::ranges::find(layout.fields, column, &RecordField::column) == layout.fields.end()) {
            layout.fields.push_back({column, property.type, stored, offset, 0});
        }
        offset += scalar_bytes(stored);
    }
    for (RecordField& field : layout.fields)
        field.stride = offset;
    return layout;
}

std::size_t least_bytes(const PlyElement& element, PlyEncoding encoding) {
    std::size_t bytes = 0;
    for (const PlyProperty& property : element.properties) {
        bytes += encoding == PlyEncoding::kAscii
                     ? 2  // a digit and what parts it from the next
                     : scalar_bytes(property.list_count_type.value_or(property.type));
    }
    return bytes;
}

class PlyFile final : public ScanFile {
  public:
    explicit PlyFile(InputFile file)
        : file_(std::move(file)),
          header_(read_ply_header(file_)),
          bytes_(file_, header_.data_offset) {}

    Format format() const override {
        constexpr const char* kEncodings[] = {"ascii", "binary_little_endian", "binary_big_endian"};
        return {"PLY", header_.version + " " + kEncodings[static_cast<int>(header_.encoding)]};
    }

    bool next_scan(ScanHeader& header) override {
        if (std::exchange(begun_, true)) {
            left_ = 0;
            return false;
        }
        header = {};
        read_cloud_comments(header_.comments, header);

        const auto vertex = std::ranges::find(header_.elements, "vertex", &PlyElement::name);
        if (vertex == header_.elements.end() || vertex->count == 0) return true;
        begin_points(*vertex);
        header.declared_points = vertex->count;
        header.columns = columns_of(layout_);
        header.colour_bits = colour_bits(layout_);
        for (const PlyProperty& property : vertex->properties) {
            const Column column =
                property.list_count_type ? Column::kNone : column_named(property.name);
            const std::string type(scalar_name(property.type));
            header.fields.push_back({property.name,
                                     property.list_count_type ? "list of " + type : type,
                                     std::string(column_name(column))});
        }
        return true;
    }

    bool next_block(PointBlock& block) override {
        block.resize(0, {});
        if (left_ == 0) return false;
        if (records_left_ == 0) fill_records();
        block.resize(records_left_, columns_of(layout_));
        decode_records(layout_, records_.data(), records_left_, 0, block);
        left_ -= std::exchange(records_left_, 0);
        return true;
    }

  private:
    void begin_points(const PlyElement& vertex) {
        vertex_ = &vertex;
        layout_ = layout_of(vertex, header_.encoding);
        if (!has_positions(layout_)) {
            file_.fail("its points have no x, y and z; export it with positions");
        }
        record_bytes_ = layout_.fields.front().stride;
        if (header_.encoding == PlyEncoding::kAscii) lines_.emplace(file_, header_.data_offset);
        for (const PlyElement& element : header_.elements) {
            if (&element == &vertex) break;
            pass_over(element);
        }
        const std::uint64_t bytes = lines_ ? file_.size() - lines_->offset() + 1 : bytes_.left();
        const std::uint64_t most = bytes / least_bytes(vertex, header_.encoding);
        if (vertex.count > most) {
            file_.fail(
                fmt::format("it announces {} points but holds at most {}; copy or export it again",
                            vertex.count, most));
        }
        left_ = vertex.count;
        fill_records();
        choose_colour_factor(layout_, records_.data(), records_left_);
    }

    void pass_over(const PlyElement& element) {
        if (element.properties.empty()) return;
        if (lines_) {
            for (std::uint64_t i = 0; i < element.count; ++i)
                next_line();
        } else if (!element.has_lists()) {
            const std::size_t record = element.record_bytes();
            if (element.count > bytes_.left() / record) {
                file_.fail(fmt::format("it ends within its element '{}'; copy or export it again",
                                       element.name));
            }
            bytes_.skip(element.count * record);
        } else {
            for (std::uint64_t i = 0; i < element.count; ++i)
                read_record(element, nullptr);
        }
    }

    /// Reads the next records of the vertex element, as many as make a block.
    void fill_records() {
        const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(
            left_, std::clamp<std::size_t>(kBlockBytes / record_bytes_, 1, kBlockPoints)));
        records_.resize(count * record_bytes_);
        if (lines_) {
            for (std::size_t i = 0; i < count; ++i)
                parse_record(&records_[i * record_bytes_]);
        } else if (!vertex_->has_lists()) {
            bytes_.read(records_.data(), records_.size());
        } else {
            for (std::size_t i = 0; i < count; ++i)
                read_record(*vertex_, &records_[i * record_bytes_]);
        }
        records_left_ = count;
    }

    /// Reads one binary record with its lists; what is not in a list goes to `into` if there is
    /// one.
    void read_record(const PlyElement& element, std::byte* into) {
        for (const PlyProperty& property : element.properties) {
            if (property.list_count_type) {
                bytes_.skip(read_list_bytes(property));
            } else if (into != nullptr) {
                bytes_.read(into, scalar_bytes(property.type));
                into += scalar_bytes(property.type);
            } else {
                bytes_.skip(scalar_bytes(property.type));
            }
        }
    }

    std::uint64_t read_list_bytes(const PlyProperty& property) {
        std::byte count[8] = {};
        const std::size_t bytes = scalar_bytes(*property.list_count_type);
        bytes_.read(count, bytes);
        if (layout_.swapped) std::reverse(count, count + bytes);
        std::uint64_t elements = 0;  // a negative count reads as too many
        std::memcpy(&elements, count, sizeof elements);
        if (elements > bytes_.left())
            file_.fail("a list in it has no end; copy or export it again");
        return elements * scalar_bytes(property.type);
    }

    std::string_view next_line() {
        std::string_view line;
        while (lines_->next(line)) {
            if (line.find_first_not_of(" \t") != std::string_view::npos) return line;
        }
        file_.fail("it ends before its header says it does; copy or export it again");
    }

    void parse_record(std::byte* into) {
        std::string_view line = next_line();
        const auto take_number = [&] {
            double value = 0.0;
            const std::string_view word = take_word(line);
            if (!parse_number(word, value)) {
                file_.fail(
                    fmt::format("'{}' stands where a number should, at byte {}; export it again",
                                word.substr(0, 40), lines_->offset()));
            }
            return value;
        };
        for (const PlyProperty& property : vertex_->properties) {
            const double value = take_number();
            if (!property.list_count_type) {
                std::memcpy(into, &value, sizeof value);
                into += sizeof value;
                continue;
            }
            for (double i = 0; i < value; ++i)
                take_number();
        }
    }

    InputFile file_;
    PlyHeader header_;
    ByteReader bytes_;
    std::optional<LineReader> lines_;  // ascii
    bool begun_ = false;
    const PlyElement* vertex_ = nullptr;
    RecordLayout layout_;
    std::size_t record_bytes_ = 0;
    std::uint64_t left_ = 0;  // points not yet handed out
    std::vector<std::byte> records_;
    std::size_t records_left_ = 0;  // of records_, not yet handed out
};

}  // namespace

bool is_ply(std::span<const std::byte> head) {
    return head.size() >= 4 && std::memcmp(head.data(), "ply", 3) == 0 &&
           std::strchr("\r\n \t", static_cast<char>(head[3])) != nullptr && head[3] != std::byte{0};
}

std::unique_ptr<ScanFile> open_ply(InputFile file, const ReadSettings&) {
    return std::make_unique<PlyFile>(std::move(file));
}

}  // namespace glowworm

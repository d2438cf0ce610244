#include "preprocess/read/las.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "preprocess/read/columns.h"
#include "preprocess/read/las_header.h"
#include "preprocess/read/las_records.h"
#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

constexpr std::size_t kBlockPoints = std::size_t{1} << 16;
constexpr std::size_t kBlockBytes = std::size_t{1} << 23;  // extra bytes can make records of 64 kB
constexpr std::size_t kSamples = 64;  // places where colours are looked at, and records at each

constexpr LazLayers kNeeded{.flags = true,
                            .classification = false,
                            .intensity = true,
                            .gps_time = true,
                            .colour = true,
                            .infrared = false,
                            .extra_bytes = false};

/// Largest colour channel among `count` records.
std::uint16_t largest_channel(const std::byte* records, std::size_t count,
                              const LasHeader& header) {
    const std::uint32_t colour = las_point_format(header.point_format).colour;
    std::uint16_t largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::byte* at = records + i * header.record_bytes + colour;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            largest = std::max(largest, load<std::uint16_t>(at + 2 * channel));
        }
    }
    return largest;
}

class LasFile final : public ScanFile {
  public:
    explicit LasFile(InputFile file)
        : file_(std::move(file)), header_(read_las_header(file_)), normals_(find_normals()) {
        LazLayers wanted = kNeeded;
        wanted.extra_bytes = normals_[0] != nullptr;
        stream_ = open_las_records(file_, header_, wanted);
    }

    Format format() const override {
        const std::string points =
            fmt::format("1.{} point format {}", header_.version_minor, header_.point_format);
        if (!header_.compressed) return {"LAS", points};
        return {"LAZ", points + ", LASzip " + stream_->compression()};
    }

    bool next_scan(ScanHeader& scan) override {
        if (entered_) {
            left_ = 0;
            return false;
        }
        entered_ = true;
        left_ = header_.point_count;
        read_more();
        choose_colour_shift();

        const LasPointFormat& point = las_point_format(header_.point_format);
        columns_ = {};
        columns_.intensities = true;
        columns_.colours = point.colour != 0;
        columns_.times = point.gps_time != 0;
        columns_.normals = normals_[0] != nullptr;

        scan = {};
        scan.declared_points = header_.point_count;
        scan.columns = columns_;
        scan.colour_bits = columns_.colours ? (colour_shift_ == 0 ? 8 : 16) : 0;
        scan.crs = header_.crs;
        scan.notes = header_.notes;
        describe_fields(scan);
        describe_file(scan);
        return true;
    }

    bool next_block(PointBlock& block) override {
        if (buffered_ == 0) read_more();
        block.resize(buffered_, columns_);
        if (buffered_ == 0) return false;
        decode(block);
        drop_withheld(block);
        buffered_ = 0;
        return true;
    }

  private:
    void read_more() {
        const std::size_t most = std::min(kBlockPoints, kBlockBytes / header_.record_bytes);
        buffered_ = static_cast<std::size_t>(std::min<std::uint64_t>(left_, most));
        if (records_.size() < buffered_ * header_.record_bytes) {
            records_.resize(buffered_ * header_.record_bytes);
        }
        stream_->read(records_.data(), buffered_);
        left_ -= buffered_;
    }

    /// Colours are 16 bits a channel; some writers put 8-bit values there.
    void choose_colour_shift() {
        if (las_point_format(header_.point_format).colour == 0) return;
        std::uint16_t largest = largest_channel(records_.data(), buffered_, header_);
        if (!header_.compressed && largest <= 255) {
            std::vector<std::byte> sample(kSamples * header_.record_bytes);
            for (std::size_t i = 1; i < kSamples; ++i) {
                const std::uint64_t first = header_.point_count / kSamples * i;
                const std::size_t count =
                    std::min<std::uint64_t>(kSamples, header_.point_count - first);
                file_.read_exactly(header_.point_offset + first * header_.record_bytes,
                                   sample.data(), count * header_.record_bytes);
                largest = std::max(largest, largest_channel(sample.data(), count, header_));
            }
        }
        colour_shift_ = largest > 0 && largest <= 255 ? 0 : 8;
    }

    std::array<const LasExtraField*, 3> find_normals() const {
        std::array<const LasExtraField*, 3> found{};
        for (const LasExtraField& field : header_.extra_fields) {
            const Column column = column_named(field.name);
            if (field.code != 0 && column >= Column::kNormalX && column <= Column::kNormalZ) {
                found[static_cast<std::size_t>(column) -
                      static_cast<std::size_t>(Column::kNormalX)] = &field;
            }
        }
        if (found[0] == nullptr || found[1] == nullptr || found[2] == nullptr) return {};
        return found;
    }

    void decode(PointBlock& block) const {
        const LasPointFormat& point = las_point_format(header_.point_format);
        const std::size_t stride = header_.record_bytes;
        const std::byte* first = records_.data();
        const Vec3d scale = header_.scale, offset = header_.offset;
        for (std::size_t i = 0; i < buffered_; ++i) {
            const std::byte* at = first + i * stride;
            block.positions[i] = {load<std::int32_t>(at) * scale.x + offset.x,
                                  load<std::int32_t>(at + 4) * scale.y + offset.y,
                                  load<std::int32_t>(at + 8) * scale.z + offset.z};
            block.intensities[i] = load<std::uint16_t>(at + 12);
        }
        for (std::size_t i = 0; columns_.colours && i < buffered_; ++i) {
            const std::byte* at = first + i * stride + point.colour;
            const auto channel = [&](std::size_t c) {
                return static_cast<std::uint8_t>(load<std::uint16_t>(at + 2 * c) >> colour_shift_);
            };
            block.colours[i] = {channel(0), channel(1), channel(2)};
        }
        for (std::size_t i = 0; columns_.times && i < buffered_; ++i) {
            block.times[i] = load<double>(first + i * stride + point.gps_time);
        }
        for (std::size_t i = 0; columns_.normals && i < buffered_; ++i) {
            const std::byte* at = first + i * stride;
            for (int axis = 0; axis < 3; ++axis) {
                block.normals[i][axis] =
                    static_cast<float>(normals_[static_cast<std::size_t>(axis)]->value(at));
            }
        }
    }

    void drop_withheld(PointBlock& block) const {
        const LasPointFormat& point = las_point_format(header_.point_format);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < buffered_; ++i) {
            const std::byte flags = records_[i * header_.record_bytes + point.flags];
            if ((flags & std::byte{point.withheld}) != std::byte{0}) continue;
            if (kept != i) {
                block.positions[kept] = block.positions[i];
                block.intensities[kept] = block.intensities[i];
                if (columns_.colours) block.colours[kept] = block.colours[i];
                if (columns_.times) block.times[kept] = block.times[i];
                if (columns_.normals) block.normals[kept] = block.normals[i];
            }
            ++kept;
        }
        block.resize(kept, columns_);
        block.invalid = buffered_ - kept;
    }

    void describe_fields(ScanHeader& scan) const {
        const LasPointFormat& point = las_point_format(header_.point_format);
        for (const char* name : {"x", "y", "z"})
            scan.fields.push_back({name, "int32", name});
        scan.fields.push_back({"intensity", "uint16", "intensity"});
        for (const char* name :
             {"return number", "classification", "scan angle", "user data", "point source"}) {
            scan.fields.push_back({name, "bits", ""});
        }
        if (point.gps_time != 0) scan.fields.push_back({"GPS time", "float64", "time"});
        for (const char* name : {"red", "green", "blue"}) {
            if (point.colour != 0) scan.fields.push_back({name, "uint16", name});
        }
        for (const LasExtraField& field : header_.extra_fields) {
            const bool normal =
                std::find(normals_.begin(), normals_.end(), &field) != normals_.end();
            scan.fields.push_back(
                {field.name, field.type,
                 normal ? std::string(column_name(column_named(field.name))) : std::string()});
        }
    }

    void describe_file(ScanHeader& scan) const {
        const auto say = [&](const char* key, const std::string& value) {
            if (!value.empty()) scan.metadata.emplace_back(key, value);
        };
        say("system", header_.system);
        say("software", header_.software);
        say("created", header_.created);
        if (columns_.times) {
            say("GPS time", header_.encoding & 1 ? "standard, less 1e9 s" : "seconds of the week");
        }
    }

    InputFile file_;
    LasHeader header_;
    std::array<const LasExtraField*, 3> normals_;  // all or none
    std::unique_ptr<LasRecordStream> stream_;
    ColumnSet columns_;
    int colour_shift_ = 8;
    bool entered_ = false;
    std::uint64_t left_ = 0;          // points not yet in records_
    std::vector<std::byte> records_;  // the block that comes next
    std::size_t buffered_ = 0;        // points in it
};

}  // namespace

bool is_las(std::span<const std::byte> head) {
    return head.size() >= 4 && std::memcmp(head.data(), "LASF", 4) == 0;
}

std::unique_ptr<ScanFile> open_las(InputFile file, const ReadSettings&) {
    return std::make_unique<LasFile>(std::move(file));
}

}  // namespace glowworm

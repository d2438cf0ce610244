#include "preprocess/read/e57.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

#include "preprocess/read/e57_header.h"
#include "preprocess/read/e57_vector.h"
#include "preprocess/read/missing_values.h"

namespace glowworm {
namespace {

constexpr std::size_t kBlockPoints = std::size_t{1} << 16;

/// What the values of a point are read for, in the order in which they are asked of E57Vector.
enum Use : std::size_t {
    kX,
    kY,
    kZ,  // or range, azimuth, elevation
    kInvalid,
    kRed,
    kGreen,
    kBlue,
    kIntensity,
    kNormalX,
    kNormalY,
    kNormalZ,
    kTime,
    kRow,
    kColumn,
    kNoColour,
    kNoIntensity,
    kUseCount,
};

constexpr const char* kCartesian[kUseCount] = {
    "cartesianX", "cartesianY",  "cartesianZ",     "cartesianInvalidState",
    "colorRed",   "colorGreen",  "colorBlue",      "intensity",
    "normalX",    "normalY",     "normalZ",        "timeStamp",
    "rowIndex",   "columnIndex", "isColorInvalid", "isIntensityInvalid",
};
constexpr const char* kSpherical[4] = {"sphericalRange", "sphericalAzimuth", "sphericalElevation",
                                       "sphericalInvalidState"};
constexpr const char* kMeanings[kUseCount] = {
    "x",  "y",  "z",  "no return", "red", "green",  "blue",      "intensity",
    "nx", "ny", "nz", "time",      "row", "column", "no colour", "no intensity"};

/// value * factor + shift maps a field's declared range to 0..most.
struct Scaling {
    double factor = 1.0, shift = 0.0;
};

Scaling scaling_to(double most, const E57Range& range) {
    const double factor = most / (range.most - range.least);
    return {factor, -range.least * factor};
}

/// The range that a field's own type declares; nothing for floats and for constants.
std::optional<E57Range> declared_range(const E57Field& field) {
    const bool integer =
        field.type == E57Field::Type::kInteger || field.type == E57Field::Type::kScaledInteger;
    const E57Range range{static_cast<double>(field.minimum) * field.scale + field.offset,
                         static_cast<double>(field.maximum) * field.scale + field.offset};
    if (!integer || !(range.least < range.most)) return std::nullopt;
    return range;
}

std::string type_name(const E57Field& field) {
    switch (field.type) {
        case E57Field::Type::kFloat:
            return "float32";
        case E57Field::Type::kDouble:
            return "float64";
        case E57Field::Type::kString:
            return "text";
        case E57Field::Type::kInteger:
            return fmt::format("{}-bit integer", field.bits);
        case E57Field::Type::kScaledInteger:
            break;
    }
    return fmt::format("{}-bit integer x {}", field.bits, field.scale);
}

std::uint32_t grid_index(double value) {
    constexpr double kMost = 4294967295.0;
    return static_cast<std::uint32_t>(value > 0.0 ? std::min(value, kMost) : 0.0);
}

class E57Reader final : public ScanFile {
  public:
    E57Reader(InputFile file, bool check_crc)
        : file_(std::move(file)), pages_(file_, check_crc), content_(read_e57_header(pages_)) {}

    Format format() const override { return {"E57", content_.version}; }

    bool next_scan(ScanHeader& header) override {
        vector_.reset();
        if (next_ == content_.scans.size()) return false;
        scan_ = &content_.scans[next_++];
        choose_fields();
        choose_scaling();
        vector_ = std::make_unique<E57Vector>(pages_, *scan_, wanted_);
        describe(header);
        return true;
    }

    bool next_block(PointBlock& block) override {
        const std::size_t count = vector_ ? vector_->read(kBlockPoints, values_) : 0;
        block.resize(count, columns_);
        if (count == 0) return false;
        std::size_t kept = 0;
        const double* invalid = values_of(kInvalid);
        const double* no_colour = columns_.colours ? values_of(kNoColour) : nullptr;
        const double* no_intensity = columns_.intensities ? values_of(kNoIntensity) : nullptr;
        no_colour_.resize(count);
        no_intensity_.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            if (invalid != nullptr && invalid[i] != 0.0) continue;
            block.positions[kept] = position(i);
            if (columns_.colours) block.colours[kept] = colour(i);
            if (columns_.intensities) {
                block.intensities[kept] = static_cast<float>(
                    values_of(kIntensity)[i] * intensity_.factor + intensity_.shift);
            }
            if (columns_.normals) {
                block.normals[kept] = {static_cast<float>(values_of(kNormalX)[i]),
                                       static_cast<float>(values_of(kNormalY)[i]),
                                       static_cast<float>(values_of(kNormalZ)[i])};
            }
            if (columns_.times) block.times[kept] = values_of(kTime)[i];
            if (columns_.grid) {
                block.grid[kept] = {grid_index(values_of(kRow)[i]),
                                    grid_index(values_of(kColumn)[i])};
            }
            if (no_colour != nullptr) no_colour_[kept] = no_colour[i] != 0.0;
            if (no_intensity != nullptr) no_intensity_[kept] = no_intensity[i] != 0.0;
            ++kept;
        }
        block.resize(kept, columns_);
        block.invalid = count - kept;
        if (no_colour != nullptr) {
            block.no_colour = fill_missing(std::span(no_colour_).first(kept), block.colours);
        }
        if (no_intensity != nullptr) {
            block.no_intensity =
                fill_missing(std::span(no_intensity_).first(kept), block.intensities);
        }
        return true;
    }

  private:
    void choose_fields() {
        use_of_.fill(-1);
        spherical_ = scan_->field("cartesianX") < 0;
        for (std::size_t use = 0; use < kUseCount; ++use) {
            use_of_[use] =
                scan_->field(spherical_ && use <= kInvalid ? kSpherical[use] : kCartesian[use]);
        }
        for (const std::size_t first : {std::size_t{kRed}, std::size_t{kNormalX}}) {
            if (use_of_[first] < 0 || use_of_[first + 1] < 0 || use_of_[first + 2] < 0) {
                for (std::size_t i = 0; i < 3; ++i)
                    use_of_[first + i] = -1;
            }
        }
        if (scan_->record_count > 0 && (use_of_[kX] < 0 || use_of_[kY] < 0 || use_of_[kZ] < 0)) {
            file_.fail(fmt::format("scan {} of it has no coordinates; export it again", next_));
        }
        wanted_.clear();
        for (std::size_t use = 0; use < kUseCount; ++use) {
            if (use_of_[use] < 0) continue;
            const auto number = static_cast<std::size_t>(use_of_[use]);
            if (scan_->fields[number].type == E57Field::Type::kString) {
                file_.fail(fmt::format("the field {} of its scan {} is text; export it again",
                                       scan_->fields[number].name, next_));
            }
            use_of_[use] = static_cast<int>(wanted_.size());
            wanted_.push_back(number);
        }
        columns_ = {};
        columns_.colours = use_of_[kRed] >= 0;
        columns_.intensities = use_of_[kIntensity] >= 0;
        columns_.normals = use_of_[kNormalX] >= 0;
        columns_.times = use_of_[kTime] >= 0;
        columns_.grid = use_of_[kRow] >= 0 && use_of_[kColumn] >= 0;
    }

    const E57Field& field_for(std::size_t use) const {
        return scan_->fields[wanted_[static_cast<std::size_t>(use_of_[use])]];
    }

    void choose_scaling() {
        intensity_ = {};
        if (columns_.intensities) {
            std::optional<E57Range> range = scan_->intensity_limits;
            if (!range) range = declared_range(field_for(kIntensity));
            if (range) intensity_ = scaling_to(1.0, *range);
        }
        for (std::size_t i = 0; columns_.colours && i < 3; ++i) {
            const std::optional<E57Range> declared = declared_range(field_for(kRed + i));
            std::optional<E57Range> range = scan_->colour_limits[i];
            // Limits that the field cannot reach (65535 of 8 bits) are another field's.
            if (!range || (declared && range->most > declared->most)) range = declared;
            colour_[i] = scaling_to(255.0, range.value_or(E57Range{0.0, 1.0}));
        }
    }

    void describe(ScanHeader& header) const {
        header = {};
        header.name = scan_->name;
        header.declared_points = scan_->record_count;
        header.columns = columns_;
        header.T_world_scan = scan_->T_world_scan;
        // A grid of rows and columns, and angles, are what a scanner sees from where it stands.
        header.has_viewpoint = spherical_ || columns_.grid;
        if (columns_.colours) {
            const E57Field& red = field_for(kRed);
            header.colour_bits = declared_range(red) ? (red.bits <= 8 ? 8 : 16) : 32;
        }
        header.crs = content_.crs;
        header.notes = scan_->notes;
        for (std::size_t i = 0; i < scan_->fields.size(); ++i) {
            std::string meaning;
            for (std::size_t use = 0; use < kUseCount; ++use) {
                if (use_of_[use] >= 0 && wanted_[static_cast<std::size_t>(use_of_[use])] == i) {
                    meaning = spherical_ && use < kInvalid ? "position" : kMeanings[use];
                }
            }
            header.fields.push_back({scan_->fields[i].name, type_name(scan_->fields[i]), meaning});
        }
        const auto say = [&](const char* key, const std::string& value) {
            if (!value.empty()) header.metadata.emplace_back(key, value);
        };
        say("software", content_.library);
        say("sensor", scan_->sensor);
        say("description", scan_->description);
    }

    const double* values_of(std::size_t use) const {
        return use_of_[use] < 0 ? nullptr : values_[static_cast<std::size_t>(use_of_[use])].data();
    }

    Vec3d position(std::size_t i) const {
        const double a = values_of(kX)[i], b = values_of(kY)[i], c = values_of(kZ)[i];
        if (!spherical_) return {a, b, c};
        // Range, azimuth and elevation (E2807-11, 8.4.4).
        return {a * std::cos(c) * std::cos(b), a * std::cos(c) * std::sin(b), a * std::sin(c)};
    }

    Rgb8 colour(std::size_t i) const {
        std::array<std::uint8_t, 3> channels{};
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = values_of(kRed + c)[i] * colour_[c].factor + colour_[c].shift;
            // Written so that NaN becomes 0.
            channels[c] =
                static_cast<std::uint8_t>(value > 0.0 ? std::min(value, 255.0) + 0.5 : 0.0);
        }
        return {channels[0], channels[1], channels[2]};
    }

    InputFile file_;
    E57Pages pages_;
    E57File content_;
    std::size_t next_ = 0;
    const E57Scan* scan_ = nullptr;
    std::unique_ptr<E57Vector> vector_;

    bool spherical_ = false;
    std::array<int, kUseCount> use_of_{};  // index into wanted_, -1 where the scan has none
    std::vector<std::size_t> wanted_;      // fields of the scan
    ColumnSet columns_;
    Scaling intensity_;
    std::array<Scaling, 3> colour_;
    std::vector<std::vector<double>> values_;
    std::vector<std::uint8_t> no_colour_, no_intensity_;  // of the points that are kept
};

}  // namespace

bool is_e57(std::span<const std::byte> head) {
    return head.size() >= 8 && std::memcmp(head.data(), "ASTM-E57", 8) == 0;
}

std::unique_ptr<ScanFile> open_e57(InputFile file, const ReadSettings& settings) {
    return std::make_unique<E57Reader>(std::move(file), settings.check_crc);
}

}  // namespace glowworm

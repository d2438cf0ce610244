#include "preprocess/read/pcd_header.h"

#include <fmt/format.h>

#include <numeric>
#include <string_view>

#include "preprocess/read/line_reader.h"

namespace glowworm {
namespace {

constexpr int kMostLines = 4096;
constexpr std::uint64_t kMostValuesPerField = 4096;

std::vector<std::string> words_of(std::string_view line) {
    std::vector<std::string> words;
    for (auto word = take_word(line); !word.empty(); word = take_word(line))
        words.emplace_back(word);
    return words;
}

std::uint64_t count_in(const InputFile& file, std::string_view keyword, std::string_view words) {
    std::uint64_t count = 0;
    if (!parse_count(take_word(words), count)) {
        file.fail(fmt::format("its PCD header has no number after {}; export it again", keyword));
    }
    return count;
}

ScalarType type_of(const InputFile& file, std::string_view letter, std::string_view size) {
    struct Known {
        std::string_view letter, size;
        ScalarType type;
    };
    constexpr Known kKnown[] = {{"I", "1", ScalarType::kI8},  {"I", "2", ScalarType::kI16},
                                {"I", "4", ScalarType::kI32}, {"I", "8", ScalarType::kI64},
                                {"U", "1", ScalarType::kU8},  {"U", "2", ScalarType::kU16},
                                {"U", "4", ScalarType::kU32}, {"U", "8", ScalarType::kU64},
                                {"F", "4", ScalarType::kF32}, {"F", "8", ScalarType::kF64}};
    for (const Known& known : kKnown) {
        if (known.letter == letter && known.size == size) return known.type;
    }
    file.fail(
        fmt::format("its PCD header has a field of the unknown type {} and size {}; export it "
                    "again",
                    letter, size));
}

std::optional<Eigen::Isometry3d> viewpoint_in(std::string_view words) {
    double v[7];
    for (double& number : v) {
        if (!parse_number(take_word(words), number) || !std::isfinite(number)) return std::nullopt;
    }
    const Eigen::Quaterniond rotation(v[3], v[4], v[5], v[6]);  // w x y z
    if (!(rotation.norm() > 1e-6)) return std::nullopt;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = rotation.normalized().toRotationMatrix();
    pose.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
    if (pose.isApprox(Eigen::Isometry3d::Identity(), 1e-15)) return std::nullopt;
    return pose;
}

/// The header's rows of words, which are joined to fields once all are read.
struct Rows {
    std::vector<std::string> names, sizes, types, counts;
};

std::vector<PcdField> fields_of(const InputFile& file, const Rows& rows) {
    const std::size_t n = rows.names.size();
    if (n == 0 || rows.sizes.size() != n || rows.types.size() != n ||
        (!rows.counts.empty() && rows.counts.size() != n)) {
        file.fail("its PCD header has not as many SIZE, TYPE and COUNT as FIELDS; export it again");
    }
    std::vector<PcdField> fields;
    for (std::size_t i = 0; i < n; ++i) {
        std::uint64_t count = 1;
        if (!rows.counts.empty() &&
            (!parse_count(rows.counts[i], count) || count > kMostValuesPerField)) {
            file.fail(fmt::format("its PCD header has the field count '{}'; export it again",
                                  rows.counts[i]));
        }
        fields.push_back({rows.names[i], type_of(file, rows.types[i], rows.sizes[i]),
                          static_cast<std::size_t>(count)});
    }
    return fields;
}

}  // namespace

std::size_t PcdHeader::record_bytes() const {
    return std::accumulate(fields.begin(), fields.end(), std::size_t{0},
                           [](std::size_t sum, const PcdField& field) {
                               return sum + scalar_bytes(field.type) * field.count;
                           });
}

PcdHeader read_pcd_header(const InputFile& file) {
    PcdHeader header;
    Rows rows;
    std::optional<std::uint64_t> points;
    LineReader lines(file);
    std::string_view line;
    for (int count = 0; count < kMostLines && lines.next(line); ++count) {
        std::string_view words = line;
        const std::string_view keyword = take_word(words);
        if (keyword.starts_with('#')) {
            const std::size_t begin = line.find_first_not_of("# ");
            header.comments.emplace_back(begin < line.size() ? line.substr(begin) : "");
        } else if (keyword == "VERSION") {
            header.version = take_word(words);
        } else if (keyword == "FIELDS" || keyword == "COLUMNS") {
            rows.names = words_of(words);
        } else if (keyword == "SIZE") {
            rows.sizes = words_of(words);
        } else if (keyword == "TYPE") {
            rows.types = words_of(words);
        } else if (keyword == "COUNT") {
            rows.counts = words_of(words);
        } else if (keyword == "WIDTH") {
            header.width = count_in(file, keyword, words);
        } else if (keyword == "HEIGHT") {
            header.height = count_in(file, keyword, words);
        } else if (keyword == "VIEWPOINT") {
            header.viewpoint = viewpoint_in(words);
        } else if (keyword == "POINTS") {
            points = count_in(file, keyword, words);
        } else if (keyword == "DATA") {
            const std::string_view data = take_word(words);
            if (data == "ascii")
                header.encoding = PcdEncoding::kAscii;
            else if (data == "binary")
                header.encoding = PcdEncoding::kBinary;
            else if (data == "binary_compressed")
                header.encoding = PcdEncoding::kBinaryCompressed;
            else
                file.fail(
                    fmt::format("its PCD data are '{}', which Glowworm does not know; save it "
                                "as binary",
                                data.substr(0, 40)));
            header.fields = fields_of(file, rows);
            // A product that wraps round is caught against the bytes that are there.
            header.points = points.value_or(header.width * header.height);
            header.data_offset = lines.offset();
            return header;
        } else if (!keyword.empty()) {
            file.fail(fmt::format("its PCD header has the unknown line '{}'; export it again",
                                  line.substr(0, 80)));
        }
    }
    file.fail("its PCD header has no DATA line; copy or export it again");
}

}  // namespace glowworm

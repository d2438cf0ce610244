#include "preprocess/read/ptx.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "preprocess/read/line_reader.h"
#include "preprocess/read/table.h"

namespace glowworm {
namespace {

constexpr std::size_t kBlockPoints = 65536;
constexpr std::size_t kHeaderLines = 10;
constexpr std::size_t kHeaderNumbers[kHeaderLines] = {1, 1, 3, 3, 3, 3, 4, 4, 4, 4};

/// The header before each scan.
struct PtxHeader {
    std::uint64_t columns = 0, rows = 0;
    Eigen::Vector3d scanner;  // m, world
    Eigen::Matrix4d matrix;   // column vectors: world = matrix * point
    std::uint64_t points() const {
        return rows != 0 && columns > UINT64_MAX / rows ? UINT64_MAX : columns * rows;
    }
};

/// Rigid to the digits that PTX writers give; the rotation is then made exact.
std::optional<Eigen::Isometry3d> rigid(const Eigen::Matrix4d& matrix) {
    const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
    const bool orthogonal = (R * R.transpose()).isApprox(Eigen::Matrix3d::Identity(), 1e-3);
    if (!orthogonal || R.determinant() < 0.0 || !matrix.allFinite()) return std::nullopt;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (!R.isIdentity(0.0)) pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
    pose.translation() = matrix.topRightCorner<3, 1>();
    return pose;
}

class PtxFile final : public ScanFile {
  public:
    explicit PtxFile(InputFile file) : file_(std::move(file)), lines_(file_) {}

    Format format() const override { return {"PTX", "text"}; }

    bool next_scan(ScanHeader& header) override {
        for (std::string_view line; left_ > 0 && lines_.next(line); --left_) {
        }
        PtxHeader ptx;
        if (!read_header(ptx)) return false;
        header = {};
        left_ = total_ = ptx.points();
        rows_ = invalid_ = 0;
        cells_.clear();
        // A single row or column is a list that is no grid.
        const bool grid = ptx.columns > 1 && ptx.rows > 1 && ptx.columns <= UINT32_MAX;
        grid_rows_ = grid ? ptx.rows : 0;
        header.declared_points = left_;
        set_pose(ptx, header);
        layout_.fields.clear();
        read_rows();
        header.columns = columns_of(layout_);
        header.columns.grid = grid;
        header.colour_bits = colour_bits(layout_);
        for (const RecordField& field : layout_.fields) {
            header.fields.push_back({std::string(column_name(field.column)), "text",
                                     std::string(column_name(field.column))});
        }
        first_ = false;
        return true;
    }

    bool next_block(PointBlock& block) override {
        if (rows_ == 0 && invalid_ == 0) read_rows();
        if (rows_ == 0 && invalid_ == 0) {
            block.resize(0, {});
            return false;
        }
        block.resize(rows_, columns_of(layout_));
        block.invalid = std::exchange(invalid_, 0);
        if (grid_rows_ > 0) block.grid = std::exchange(cells_, {});
        decode_records(layout_, reinterpret_cast<const std::byte*>(values_.data()),
                       std::exchange(rows_, 0), 0, block);
        if (affine_) apply(*affine_, block);
        return true;
    }

  private:
    bool read_header(PtxHeader& ptx) {
        double numbers[kHeaderLines][4];
        std::string_view line;
        for (std::size_t i = 0; i < kHeaderLines; ++i) {
            do {
                if (!lines_.next(line)) {
                    if (i == 0) return false;
                    fail_in_header();
                }
            } while (i == 0 && line.find_first_not_of(" \t") == std::string_view::npos);
            if (count_numbers(line) < kHeaderNumbers[i]) fail_in_header();
            for (std::size_t k = 0; k < kHeaderNumbers[i]; ++k)
                parse_number(take_word(line), numbers[i][k]);
        }
        constexpr double kMost = 1e15;
        for (const int i : {0, 1}) {
            if (!(numbers[i][0] >= 0.0 && numbers[i][0] <= kMost)) fail_in_header();
        }
        ptx.columns = static_cast<std::uint64_t>(numbers[0][0]);
        ptx.rows = static_cast<std::uint64_t>(numbers[1][0]);
        ptx.scanner = {numbers[2][0], numbers[2][1], numbers[2][2]};
        for (int r = 0; r < 4; ++r) {
            for (int c = 0; c < 4; ++c)
                ptx.matrix(r, c) = numbers[6 + c][r];
        }
        return true;
    }

    [[noreturn]] void fail_in_header() const {
        file_.fail(fmt::format("the header of a PTX scan is broken in line {}; export it again",
                               lines_.line_number()));
    }

    void set_pose(const PtxHeader& ptx, ScanHeader& header) {
        affine_.reset();
        const std::optional<Eigen::Isometry3d> pose = rigid(ptx.matrix);
        if (!pose) {
            if (!ptx.matrix.allFinite())
                file_.fail("a matrix in it is not finite; export it again");
            affine_ = ptx.matrix;
            header.notes.push_back(fmt::format(
                "The matrix before line {} is not rigid; it was applied to the points of its scan, "
                "which has no pose.",
                lines_.line_number() + 1));
            return;
        }
        const bool identity = ptx.matrix.isIdentity(0.0);
        if (identity && first_ && !another_scan_follows()) return;
        header.T_world_scan = pose;
        header.has_viewpoint = !identity && (ptx.scanner - pose->translation()).norm() < 0.01;
    }

    /// Looks ahead whether lines follow the points of the scan that has just begun.
    bool another_scan_follows() const {
        LineReader ahead(file_);
        std::string_view line;
        for (std::uint64_t i = 0; i < kHeaderLines + left_; ++i) {
            if (!ahead.next(line)) return false;
        }
        while (ahead.next(line)) {
            if (line.find_first_not_of(" \t") != std::string_view::npos) return true;
        }
        return false;
    }

    /// Reads the next lines of the scan, as many as make a block.
    void read_rows() {
        std::string_view line;
        while (left_ > 0 && rows_ + invalid_ < kBlockPoints) {
            if (!lines_.next(line)) {
                left_ = 0;  // it ends early
                break;
            }
            if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
            --left_;
            if (layout_.fields.empty()) begin_rows(line);
            const std::size_t columns = shape_.columns.size();
            const std::span<double> row(&values_[rows_ * columns], columns);
            const std::size_t numbers = parse_cells(line, shape_, row, scratch_);
            if (numbers < 3) {
                file_.fail(fmt::format("line {} should hold a point and does not; export it again",
                                       lines_.line_number()));
            }
            const bool no_return = row[0] == 0.0 && row[1] == 0.0 && row[2] == 0.0;
            if (no_return) {
                ++invalid_;
                continue;
            }
            ++rows_;
            if (grid_rows_ == 0) continue;
            const std::uint64_t place = total_ - left_ - 1;  // columns one after the other
            cells_.push_back({static_cast<std::uint32_t>(place % grid_rows_),
                              static_cast<std::uint32_t>(place / grid_rows_)});
        }
    }

    /// The first point of a scan says how many columns there are.
    void begin_rows(std::string_view line) {
        const std::size_t count = count_numbers(line);
        using enum Column;
        shape_.columns = {kX, kY, kZ, kIntensity, kRed, kGreen, kBlue};
        shape_.columns.resize(count >= 7 ? 7 : count >= 4 ? 4 : 3);
        const auto rows = std::min<std::uint64_t>(kBlockPoints, file_.size() / 6 + 1);
        values_.resize(static_cast<std::size_t>(rows) * shape_.columns.size());
        layout_ = layout_of(shape_);
    }

    static void apply(const Eigen::Matrix4d& matrix, PointBlock& block) {
        for (Vec3d& p : block.positions) {
            const Eigen::Vector4d q = matrix * Eigen::Vector4d(p.x, p.y, p.z, 1.0);
            p = {q.x(), q.y(), q.z()};
        }
    }

    InputFile file_;
    LineReader lines_;
    TableShape shape_;
    RecordLayout layout_;
    std::optional<Eigen::Matrix4d> affine_;  // to be applied to the points
    bool first_ = true;
    std::uint64_t total_ = 0;      // lines of the scan
    std::uint64_t left_ = 0;       // lines of the scan not yet read
    std::uint64_t grid_rows_ = 0;  // 0: no grid
    std::vector<GridCell> cells_;  // [rows_]
    std::vector<double> values_;   // [rows_][columns]
    std::size_t rows_ = 0;         // read and not yet handed out
    std::uint64_t invalid_ = 0;
    std::string scratch_;
};

}  // namespace

bool is_ptx(std::span<const std::byte> bytes) {
    TextHead head;
    if (!read_text_head(bytes, head) || head.lines.size() < kHeaderLines) return false;
    for (std::size_t i = 0; i < kHeaderLines; ++i) {
        if (count_numbers(head.lines[i]) != kHeaderNumbers[i]) return false;
    }
    return true;
}

std::unique_ptr<ScanFile> open_ptx(InputFile file, const ReadSettings&) {
    return std::make_unique<PtxFile>(std::move(file));
}

}  // namespace glowworm

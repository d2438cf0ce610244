#include "preprocess/pipeline/cell_sample.h"

#include <algorithm>
#include <map>
#include <utility>

namespace glowworm {
namespace {

constexpr std::size_t kLeastCells = 24;
constexpr std::uint32_t kDeepest = 7;
constexpr double kLeastStride = 5.0;  // less is not worth leaving cells out

std::map<std::uint64_t, double> points_by_cell(const Grid& grid,
                                               std::span<const WeightedPlace> places,
                                               std::uint32_t level) {
    std::map<std::uint64_t, double> cells;
    for (const WeightedPlace& place : places)
        cells[code_at_level(grid.code_of(place.position), level)] += place.points;
    return cells;
}

}  // namespace

CellSample::CellSample(const Grid& grid, std::span<const WeightedPlace> places, double points)
    : grid_(grid) {
    double all = 0.0;
    for (const WeightedPlace& place : places)
        all += place.points;
    const double stride = all / points;
    std::map<std::uint64_t, double> occupied = points_by_cell(grid, places, 0);
    if (stride > kLeastStride) {
        while (level_ < kDeepest && static_cast<double>(occupied.size()) < stride * kLeastCells)
            occupied = points_by_cell(grid, places, ++level_);
    }

    // Every n-th by the number of points: one of each kind.
    std::vector<std::pair<double, std::uint64_t>> by_points;
    for (const auto& [code, weight] : occupied)
        by_points.emplace_back(weight, code);
    std::ranges::sort(by_points);
    chosen_.resize(std::size_t{1} << 3 * level_);
    const double step = level_ > 0 ? stride : 1.0;
    for (double at = 0.5 * step; at < static_cast<double>(by_points.size()); at += step) {
        const std::uint64_t code = by_points[static_cast<std::size_t>(at)].second;
        cells_.push_back({level_, code});
        chosen_[code] = true;
    }
    if (!cells_.empty())
        stands_for_ = static_cast<double>(by_points.size()) / static_cast<double>(cells_.size());
}

bool CellSample::holds(const Vec3d& position) const {
    return chosen_[code_at_level(grid_.code_of(position), level_)];
}

bool CellSample::is_near(const Vec3d& position, double margin) const {
    if (level_ == 0 || holds(position)) return true;
    for (const double x : {-margin, 0.0, margin}) {
        for (const double y : {-margin, 0.0, margin}) {
            for (const double z : {-margin, 0.0, margin}) {
                if (holds(position + Vec3d{x, y, z})) return true;
            }
        }
    }
    return false;
}

std::size_t occupied_cells(const Grid& grid, std::span<const WeightedPlace> places,
                           std::uint32_t level) {
    return points_by_cell(grid, places, level).size();
}

}  // namespace glowworm

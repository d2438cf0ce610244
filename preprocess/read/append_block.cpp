#include "preprocess/read/append_block.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

namespace glowworm {
namespace {

/// Calls `visit` with each column of `block` that is there.
template <typename Visit>
void for_each_column(PointBlock& block, Visit visit) {
    const auto visit_if_there = [&](auto& column) {
        if (!column.empty()) visit(column);
    };
    visit_if_there(block.positions);
    visit_if_there(block.normals);
    visit_if_there(block.colours);
    visit_if_there(block.intensities);
    visit_if_there(block.ndf_lengths);
    visit_if_there(block.radii);
    visit_if_there(block.stations);
    visit_if_there(block.emissions);
    visit_if_there(block.times);
    visit_if_there(block.grid);
}

/// Keeps the points for which `keep(position)` holds, in order; returns how many were dropped.
template <typename Keep>
std::uint64_t keep_points(PointBlock& block, Keep keep) {
    const auto begin = block.positions.begin();
    const auto first_dropped = std::find_if_not(begin, block.positions.end(), std::ref(keep));
    if (first_dropped == block.positions.end()) return 0;
    std::vector<std::uint32_t> kept(static_cast<std::size_t>(first_dropped - begin));
    std::iota(kept.begin(), kept.end(), 0u);
    for (std::size_t i = kept.size() + 1; i < block.size(); ++i) {
        if (keep(block.positions[i])) kept.push_back(static_cast<std::uint32_t>(i));
    }
    const std::size_t before = block.size();
    for_each_column(block, [&](auto& column) {
        for (std::size_t i = 0; i < kept.size(); ++i)
            column[i] = column[kept[i]];
        column.resize(kept.size());
    });
    return before - kept.size();
}

}  // namespace

std::uint64_t drop_not_finite(PointBlock& block) {
    return keep_points(block, [](const Vec3d& p) { return is_finite(p); });
}

std::uint64_t drop_too_far(PointBlock& block) {
    return keep_points(block, [](const Vec3d& p) {
        return std::abs(p.x) <= kFarthestMetres && std::abs(p.y) <= kFarthestMetres &&
               std::abs(p.z) <= kFarthestMetres;
    });
}

std::uint64_t drop_at_origin(PointBlock& block) {
    return keep_points(block, [](const Vec3d& p) { return p != Vec3d{}; });
}

PointBlock first_at_origin(const PointBlock& block) {
    if (std::ranges::find(block.positions, Vec3d{}) == block.positions.end()) return {};
    PointBlock first = block;
    keep_points(first, [found = false](const Vec3d& p) mutable {
        return p == Vec3d{} && !std::exchange(found, true);
    });
    first.invalid = first.no_colour = first.no_intensity = 0;
    return first;
}

Vec3d choose_offset(const PointBlock& block) {
    constexpr double kFarthest = 1000.0;  // m
    if (block.size() == 0) return {};
    Vec3d offset;
    bool far = false;
    std::vector<double> values(block.size());
    const std::size_t strays = block.size() / 100;
    for (int axis = 0; axis < 3; ++axis) {
        std::ranges::transform(block.positions, values.begin(),
                               [axis](const Vec3d& p) { return p[axis]; });
        const auto value_at = [&](std::size_t rank) {
            const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
            std::ranges::nth_element(values, place);
            return *place;
        };
        const double low = value_at(strays), high = value_at(values.size() - 1 - strays);
        far |= std::max(std::abs(low), std::abs(high)) > kFarthest;
        offset[axis] = std::round(0.5 * low + 0.5 * high);
    }
    return far ? offset : Vec3d{};
}

void append_block(const PointBlock& block, const Vec3d& offset, Points& points) {
    const std::size_t count = points.positions.size() + block.size();
    // Doubling, as insert does by itself: a file may not say how many points it holds.
    if (count > points.positions.capacity()) points.positions.reserve(2 * count);
    for (const Vec3d& p : block.positions)
        points.positions.push_back(vec3_cast<float>(p - offset));
    const auto append = [](const auto& from, auto& to) {
        to.insert(to.end(), from.begin(), from.end());
    };
    append(block.normals, points.normals);
    append(block.colours, points.colours);
    append(block.intensities, points.intensities);
    append(block.ndf_lengths, points.ndf_lengths);
    append(block.radii, points.radii);
    append(block.stations, points.stations);
    append(block.emissions, points.emissions);
    append(block.times, points.times);
    append(block.grid, points.grid);
}

void reserve_points(std::uint64_t count, const ColumnSet& columns, Points& points) {
    const auto n = static_cast<std::size_t>(count);
    points.positions.reserve(n);
    if (columns.normals) points.normals.reserve(n);
    if (columns.colours) points.colours.reserve(n);
    if (columns.intensities) points.intensities.reserve(n);
    if (columns.ndf_lengths) points.ndf_lengths.reserve(n);
    if (columns.radii) points.radii.reserve(n);
    if (columns.stations) points.stations.reserve(n);
    if (columns.emissions) points.emissions.reserve(n);
    if (columns.times) points.times.reserve(n);
    if (columns.grid) points.grid.reserve(n);
}

}  // namespace glowworm

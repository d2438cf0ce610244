#pragma once

#include <cstdint>

#include "preprocess/points.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// Drops the points of `block` whose coordinates are not finite; returns how many.
std::uint64_t drop_not_finite(PointBlock& block);

/// No place is farther from a frame's origin, m: UTM coordinates in millimetres are nearer. Numbers
/// beyond are how programs write "no value" (1e30, the largest float).
inline constexpr double kFarthestMetres = 1e10;

/// Drops the points of `block` with a coordinate beyond kFarthestMetres; returns how many.
std::uint64_t drop_too_far(PointBlock& block);

/// Drops the points of `block` exactly at the origin of the frame; returns how many.
std::uint64_t drop_at_origin(PointBlock& block);

/// The first point of `block` exactly at the origin as a block of its own; empty where none is.
PointBlock first_at_origin(const PointBlock& block);

/// The whole metres to take out of positions so that float holds them: zero where no coordinate of
/// `block` exceeds 1 km (float's step is 0.06 mm there), else the middle of the block's bounds. The
/// hundredth of the points that is farthest out on either side does not count: a single stray one
/// must not cost all the others their millimetres.
Vec3d choose_offset(const PointBlock& block);

/// Appends `block` to `points`, whose positions are relative to `offset`.
void append_block(const PointBlock& block, const Vec3d& offset, Points& points);

/// Makes room for `count` points with `columns`.
void reserve_points(std::uint64_t count, const ColumnSet& columns, Points& points);

}  // namespace glowworm

#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "octree/vec3.h"

namespace glowworm {

/// Where a moving scanner was.
struct Trajectory {
    std::vector<Vec3d> positions;  ///< m, world
    std::vector<double> times;     ///< s, the points' clock, ascending; empty where none are given

    bool empty() const { return positions.empty(); }
};

/// Lines of `x y z` or `time x y z`, what follows (a quaternion, as in TUM's format) passed over;
/// between the numbers blanks, commas or semicolons. Empty lines, those that begin with '#' and a
/// first line of words are passed over. Poses with times are sorted by them. Throws Error
/// kUnreadable where the file cannot be read or a line has no three finite numbers, kDegenerate
/// where there are no poses.
Trajectory read_trajectory(const std::filesystem::path& path);

/// Poses at least `spacing` metres from the one kept before, the first always.
Trajectory thin_trajectory(const Trajectory& trajectory, double spacing);

}  // namespace glowworm

#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <span>
#include <vector>

#include "preprocess/pipeline/cell_sample.h"
#include "preprocess/pipeline/look.h"
#include "preprocess/pipeline/pilot.h"
#include "preprocess/register/align.h"

namespace glowworm {

/// Scans beyond this many are not registered for a prediction.
inline constexpr std::size_t kMostPiloted = 24;

Vec3d transformed(const Eigen::Isometry3d& T, const Vec3d& p);

/// Where the scans lie: as it is given, else found by registering samples of them, of the first
/// kMostPiloted at least. Says in `pilot` how many pairs registration will try, and what one took.
Poses find_poses(std::span<const LookedScan> scans, const RegistrationSettings& settings,
                 const Progress& progress, Pilot& pilot);

/// The samples of the placed scans in the world, relative to the poses' origin.
std::vector<std::vector<WeightedPlace>> places_of(std::span<const LookedScan> scans,
                                                  const Poses& poses);

struct PlaceBounds {
    Vec3d low, high;  ///< m
    double longest() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

/// Round all places; there is at least one.
PlaceBounds box_of(std::span<const std::vector<WeightedPlace>> places);

/// What something grows to with all scans, having grown from `half` to `now` with the last half of
/// those placed.
double grown(double half, double now, std::size_t placed, std::size_t all);

}  // namespace glowworm

#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "preprocess/register/refine.h"
#include "preprocess/register/scan_model.h"

namespace glowworm {

/// Poses elsewhere at which the two scans agree about as well as at `fit`, best first: it is slid
/// along the two long axes of each scan, and the offsets are taken at which the agreement peaks.
/// A passage that repeats itself has such places although no keypoints may lead there. Rough: to
/// be refined. `voxel_size` in metres, of the models' coarse samples.
std::vector<Eigen::Isometry3d> slid_rivals(const ScanModel& source, const ScanModel& target,
                                           const Fit& fit, double voxel_size);

}  // namespace glowworm

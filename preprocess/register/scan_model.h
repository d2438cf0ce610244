#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "preprocess/depth_image.h"
#include "preprocess/kd_tree.h"
#include "preprocess/scan.h"

namespace glowworm {

inline Eigen::Vector3f to_eigen(const Vec3f& v) {
    return {v.x, v.y, v.z};
}
inline Vec3f to_vec3(const Eigen::Vector3f& v) {
    return {v.x(), v.y(), v.z()};
}

/// Even samples of a scan's surface, each smoothed along its normal: columns of equal length.
struct SurfaceSamples {
    double spacing = 0;            ///< m, edge of the thinning voxels
    std::vector<Vec3f> positions;  ///< m, the model's frame
    std::vector<Vec3f> normals;    ///< unit, toward the scanner where there is one
    std::vector<float> variances;  ///< m², of a position along its normal; empty: all alike
    KdTree tree;                   ///< over positions

    std::size_t size() const { return positions.size(); }
};

/// Distinctive places and what the surface around them looks like.
struct Keypoints {
    std::vector<Vec3f> positions;  ///< m, the model's frame
    std::vector<Vec3f> normals;    ///< unit
    Eigen::Matrix<float, Eigen::Dynamic, 33, Eigen::RowMajor> descriptors;  ///< [n, 33]

    std::size_t size() const { return positions.size(); }
};

/// What registration knows of one scan, in the scan's own main axes: a scan that comes turned gives
/// (but for rounding) the same samples and so the same result.
struct ScanModel {
    Eigen::Matrix3d R_model_scan = Eigen::Matrix3d::Identity();
    SurfaceSamples coarse;             ///< at the voxel size v
    SurfaceSamples fine;               ///< at v / 2
    SurfaceSamples wide;               ///< at 3/2 v, to find keypoints on
    Keypoints keypoints;               ///< empty until described
    std::optional<DepthImage> depths;  ///< where the scan has a viewpoint
    Vec3f viewpoint;                   ///< m, the scanner's place
};

/// Samples of `positions` at `spacing` metres, each on the plane through its neighbours: good
/// enough to find places again, not to align by (see patches.h). Samples without enough neighbours
/// are left out. Normals face `viewpoint` where it is given, else they agree with their neighbours'
/// and, as far as they can, point away from the middle.
SurfaceSamples sample_surface(std::span<const Vec3f> positions, double spacing,
                              const std::optional<Vec3f>& viewpoint);

/// The turn that brings the principal axes of `positions` to X, Y and Z, each pointing to its
/// longer tail; about Z alone with `upright`. Positions that are not finite are passed over.
Eigen::Matrix3d main_axes(std::span<const Vec3f> positions, bool upright);

/// The model of a (cleaned) scan at the voxel size `spacing` metres, without keypoints. Normals
/// face its viewpoint only with `toward_viewpoint`: among scans of which some have none, all are
/// turned by the same rule, or those would be inside out to the others.
ScanModel model_scan(const Scan& scan, double spacing, bool upright, bool toward_viewpoint = true);

/// A voxel size, m, that leaves about `samples` coarse samples of the median scan, fewer where it
/// has not 2.5 points for each.
double choose_voxel_size(std::span<const Scan> scans, bool upright, std::size_t samples = 9000);

}  // namespace glowworm

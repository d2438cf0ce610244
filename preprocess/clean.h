#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/points.h"

namespace glowworm {

/// Indices, ascending, of one point per occupied cell of a grid of edge `voxel_size` metres: the
/// one nearest the mean of the cell's points, the lower index where two are as near. Points that
/// are not finite are left out. Empty in, empty out. Throws Error kUsage where `voxel_size` is not
/// positive or the cloud spans more than 2²¹ cells.
std::vector<std::uint32_t> thin_indices(std::span<const Vec3f> positions, double voxel_size);

/// The points at thin_indices, all columns kept.
Points thin(const Points& points, double voxel_size);

struct OutlierSettings {
    std::uint32_t neighbours = 8;  ///< 2..64: nearest points whose mean distance is compared
    double factor = 3.0;  ///< > 1: a point this many times lonelier than its neighbours goes
    /// > 1, with a viewpoint only: a point goes when it is this many times lonelier than range
    /// times the angle between the rays around it, as a ray that ended in mid-air is.
    double ray_factor = 5.0;
};

/// Indices, ascending, of the points that are not outliers. A point's mean distance to its
/// neighbours is compared with the median of its neighbours' own, so that spacing may grow with
/// range (a local outlier factor: Breunig et al. 2000, with the median for the mean); with a
/// viewpoint at the origin also with the spacing of the rays. Points that are not finite are
/// outliers. With no more points than neighbours all are kept.
std::vector<std::uint32_t> inlier_indices(std::span<const Vec3f> positions, bool has_viewpoint,
                                          const OutlierSettings& settings = {});

struct CleanSettings {
    bool remove_outliers = true;
    OutlierSettings outliers = {};
    double voxel_size = 0.0;  ///< m, thinning; 0: none
};

struct CleanReport {
    std::uint64_t points_in = 0;
    std::uint64_t outliers = 0;  ///< removed, those that are not finite included
    std::uint64_t thinned = 0;   ///< removed
};

/// Removes outliers, then thins. All columns are kept. `has_viewpoint`: see Scan.
Points clean(const Points& points, bool has_viewpoint, const CleanSettings& settings,
             CleanReport* report = nullptr);

}  // namespace glowworm

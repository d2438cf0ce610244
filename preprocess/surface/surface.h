#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "octree/progress.h"
#include "octree/surfel.h"
#include "preprocess/points.h"
#include "preprocess/surface/delight.h"
#include "preprocess/surface/trajectory.h"

namespace glowworm {

struct SurfaceSettings {
    /// Points a plane is fitted to, the point itself among them; 6..64. Where noise or the
    /// scanner's rings leave the plane undetermined the neighbourhood grows, up to `max_k`
    /// (k..256).
    int k = 16;
    int max_k = 64;

    /// Neighbours farther than this are not neighbours, m. 0: four times the distance within which
    /// 95 % of the points have their k neighbours.
    float search_radius = 0.0f;

    /// Standard deviation of the range noise, m. Negative: estimated from the points.
    float range_noise = -1.0f;

    /// Neighbourhoods grow until the noise turns their normal by less than this, rad.
    float slope_error = 0.04f;

    /// Fit the points of one side of an edge only, where a neighbourhood crosses one.
    bool sharp_edges = true;

    /// Albedo of points without colour and intensity, linear, 0..1. Scaled intensities have it as
    /// their median. Stored as sRGB bytes like every albedo, so .5 becomes .5029.
    float default_albedo = 0.5f;

    /// Take the falloff of the scanner's own light out of the albedo (delight.h).
    bool delight = false;

    /// Where a moving scanner was, for points whose station is unknown; empty: nothing is known.
    Trajectory trajectory;
};

/// How the normals were turned to the passage.
enum class Orientation { kStations, kTrajectory, kOrigin, kPropagation, kMixed };

/// Where the albedo came from.
enum class AlbedoSource { kColours, kIntensities, kDefault };

/// What was done, for the log, `--json` and the tests.
struct SurfaceReport {
    std::size_t points = 0;       ///< given
    std::size_t surfels = 0;      ///< made
    std::size_t not_finite = 0;   ///< left out: NaN, infinite or beyond 1e7 m from the origin
    std::size_t duplicates = 0;   ///< left out: another point lies at the same place
    std::size_t isolated = 0;     ///< left out: fewer than 3 neighbours, or all on one line
    std::size_t grown = 0;        ///< fitted to more than k points
    std::size_t edges = 0;        ///< fitted to one side of an edge
    std::size_t weak = 0;         ///< expected angle error above 0.2 rad
    std::size_t unsure_side = 0;  ///< facing a side that nothing decided clearly

    /// Points without a station that face the side on which rays end on surface (a passage's
    /// inside), and those that face the other one, the closed side being too narrow for a scanner.
    std::size_t facing_inside = 0, facing_outside = 0;

    /// Points without a station that a pose of the trajectory saw.
    std::size_t seen_from_trajectory = 0;

    Orientation orientation = Orientation::kStations;
    AlbedoSource albedo = AlbedoSource::kDefault;
    DelightReport delight;        ///< where it was asked for
    double range_noise = 0.0;     ///< m, one standard deviation
    double search_radius = 0.0;   ///< m, as used
    double median_spacing = 0.0;  ///< m: square root of the area that the median surfel stands for
    double mean_ndf_length = 0.0;
};

/// "stations", "the trajectory", "the frame's origin, which most points see", "propagation",
/// "what is known of where points were seen from, propagation for the others".
std::string describe(Orientation orientation);
/// "colours", "intensities as grey", "the default".
std::string describe(AlbedoSource source);

/// Normals that face the passage, NDF lengths, radii and albedo for every point of `cloud` that has
/// a neighbourhood, in the order of the points. Normals, radii and NDF lengths that the cloud
/// already has are estimated anew. The same cloud gives the same bytes on any number of threads.
/// Throws Error kDegenerate where no point has a neighbourhood: an empty cloud, one point, all
/// points equal or on one line. `report` may be null, and so may `normal_errors`, which gets for
/// each surfel the standard error of its normal, in degrees, at most 90: how far the scatter of its
/// neighbourhood (noise and roughness) leaves it open.
SurfelCloud make_surfels(const PointCloud& cloud, const SurfaceSettings& settings,
                         SurfaceReport* report = nullptr, const Progress& progress = {},
                         std::vector<float>* normal_errors = nullptr);

}  // namespace glowworm

#include "preprocess/surface/surface.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "octree/error.h"
#include "preprocess/surface/albedo.h"
#include "preprocess/surface/ndf.h"
#include "preprocess/surface/normals.h"
#include "preprocess/surface/orientation.h"
#include "preprocess/surface/point_tree.h"
#include "preprocess/surface/range_noise.h"
#include "preprocess/surface/viewpoints.h"

namespace glowworm {
namespace {

/// Neighbours that orientation and NDF look at again; the planes may be fitted to more.
constexpr int kTableNeighbours = 12;

/// An expected angle error above this is a guess more than a normal, rad.
constexpr float kWeak = 0.2f;

SurfacePoints arrange(const PointCloud& cloud) {
    SurfacePoints points;
    points.tree = make_point_tree(cloud.points.positions);
    for (const Station& station : cloud.stations) {
        points.viewpoints.push_back(vec3_cast<float>(station.position - cloud.origin));
        points.has_viewpoint.push_back(station.has_viewpoint && is_finite(station.position));
    }
    if (cloud.points.stations.empty()) {
        // Points that do not say where they were seen from can only come from a single station.
        if (cloud.stations.size() > 1) points.has_viewpoint.assign(cloud.stations.size(), false);
        return points;
    }
    points.stations.reserve(points.size());
    for (const std::uint32_t i : points.tree.order) {
        points.stations.push_back(cloud.points.stations[i]);
    }
    return points;
}

/// Median of the distance over which a surfel stands, from a sample of them, m.
float median_spacing(const std::vector<LocalPlane>& planes) {
    std::vector<float> areas;
    const std::size_t every = std::max<std::size_t>(planes.size() / 65536, 1);
    for (std::size_t i = 0; i < planes.size(); i += every) {
        if (planes[i].area > 0.0f) areas.push_back(planes[i].area);
    }
    if (areas.empty()) return 0.0f;
    const auto middle = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
    std::nth_element(areas.begin(), middle, areas.end());
    return std::sqrt(*middle);
}

[[noreturn]] void throw_degenerate(const SurfaceReport& report) {
    std::string left_out;
    if (report.not_finite > 0) {
        left_out = "; " + std::to_string(report.not_finite) +
                   " of them are not finite or lie beyond 10 000 km from the cloud's origin";
    }
    throw Error(ExitCode::kDegenerate,
                "None of the " + std::to_string(report.points) +
                    " points lies on a surface: a normal needs at least 4 different points near "
                    "each other that are not on one line" +
                    left_out + "; check the input cloud.");
}

/// Finds for points whose station is unknown where they were seen from. Returns what all points
/// were turned by that were turned by one thing alone.
Orientation find_viewpoints(const PointCloud& cloud, const Trajectory& trajectory,
                            const std::vector<LocalPlane>& planes, SurfacePoints& points,
                            SurfaceReport& report) {
    if (!trajectory.empty()) {
        report.seen_from_trajectory += view_by_sight(trajectory, cloud.origin, planes, points);
        return Orientation::kTrajectory;
    }
    const bool any_known =
        std::ranges::find(points.has_viewpoint, true) != points.has_viewpoint.end();
    const Vec3f frame_origin = vec3_cast<float>(-cloud.origin);
    if (!any_known && is_seen_by_all(points, planes, frame_origin)) {
        view_by_sight({{Vec3d{}}, {}}, cloud.origin, planes, points);
        return Orientation::kOrigin;
    }
    return Orientation::kStations;
}

Orientation orientation_of(const OrientationReport& sides, Orientation by, std::size_t stations) {
    if (sides.toward_stations == 0) return Orientation::kPropagation;
    // One frame has one origin: what hides behind a fold follows its neighbours.
    if (by == Orientation::kOrigin) return by;
    if (sides.propagated > 0 || (by != Orientation::kStations && stations > 0)) {
        return Orientation::kMixed;
    }
    return by;
}

/// How far the points' scatter about the plane leaves its normal open, deg.
float normal_error(const LocalPlane& plane, float range_noise) {
    const float scatter = std::max(plane.thickness, range_noise);
    return std::min(plane.error_per_noise * scatter * 180.0f / std::numbers::pi_v<float>, 90.0f);
}

/// Surfels in the order of the cloud's points, those without a plane left out. In parallel.
void write_surfels(const PointCloud& cloud, const SurfacePoints& points,
                   const std::vector<LocalPlane>& planes, const std::vector<float>& ndf_lengths,
                   const std::vector<Rgb8>& albedo, float range_noise, std::vector<Surfel>& surfels,
                   std::vector<float>* normal_errors) {
    std::vector<std::uint32_t> place(cloud.points.size(), 0);
    for (std::size_t t = 0; t < points.size(); ++t)
        place[points.tree.order[t]] = planes[t].area > 0.0f ? 1 : 0;
    std::exclusive_scan(place.begin(), place.end(), place.begin(), 0u);
    const auto count = static_cast<std::size_t>(
        std::ranges::count_if(planes, [](const LocalPlane& plane) { return plane.area > 0.0f; }));
    surfels.resize(count);
    if (normal_errors) normal_errors->resize(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096),
                      [&](const auto& range) {
                          for (std::size_t t = range.begin(); t < range.end(); ++t) {
                              const LocalPlane& plane = planes[t];
                              if (!(plane.area > 0.0f)) continue;
                              const std::uint32_t i = points.tree.order[t];
                              Surfel& surfel = surfels[place[i]];
                              surfel.position = points.tree.position(t);
                              surfel.normal = normalized(plane.normal);
                              surfel.radius = std::sqrt(plane.area / std::numbers::pi_v<float>);
                              surfel.ndf_length = ndf_lengths[t];
                              surfel.albedo = to_linear(albedo[i]);
                              if (!cloud.points.emissions.empty())
                                  surfel.emission = cloud.points.emissions[i];
                              surfel.station = points.station(t);
                              if (normal_errors)
                                  (*normal_errors)[place[i]] = normal_error(plane, range_noise);
                          }
                      });
}

}  // namespace

std::string describe(Orientation orientation) {
    switch (orientation) {
        case Orientation::kStations:
            return "stations";
        case Orientation::kTrajectory:
            return "the trajectory";
        case Orientation::kOrigin:
            return "the frame's origin, which most points see";
        case Orientation::kPropagation:
            return "propagation";
        case Orientation::kMixed:
            return "what is known of where points were seen from, propagation for the others";
    }
    return {};
}

std::string describe(AlbedoSource source) {
    switch (source) {
        case AlbedoSource::kColours:
            return "colours";
        case AlbedoSource::kIntensities:
            return "intensities as grey";
        case AlbedoSource::kDefault:
            return "the default";
    }
    return {};
}

SurfelCloud make_surfels(const PointCloud& cloud, const SurfaceSettings& settings,
                         SurfaceReport* report_out, const Progress& progress,
                         std::vector<float>* normal_errors) {
    SurfaceReport report;
    report.points = cloud.points.size();

    SurfacePoints points = arrange(cloud);
    report.not_finite = points.tree.not_finite;
    report.duplicates = points.tree.duplicates;
    if (points.size() < 4) throw_degenerate(report);

    std::size_t at_stations = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        at_stations += points.is_viewed(i);
    if (!settings.trajectory.times.empty() && !cloud.points.times.empty()) {
        report.seen_from_trajectory =
            view_by_time(settings.trajectory, cloud.origin, cloud.points.times, points);
    }

    // Between long steps that count nothing: whether to stop.
    const auto hear = [&] {
        if (progress) progress(points.size(), points.size());
    };

    const CloudScale scale = measure_scale(points.tree, settings.k);
    NormalSettings fit;
    fit.k = std::clamp(settings.k, 6, 64);
    fit.max_k = std::clamp(settings.max_k, fit.k, 256);
    fit.radius = settings.search_radius > 0.0f ? settings.search_radius : 4.0f * scale.reach;
    fit.range_noise = settings.range_noise >= 0.0f ? settings.range_noise : scale.range_noise;
    fit.slope_error = settings.slope_error;

    NeighbourTable table{std::min(kTableNeighbours, fit.k - 1), {}};
    std::vector<LocalPlane> planes = fit_local_planes(points, fit, table, progress);
    for (const LocalPlane& plane : planes) {
        report.isolated += !(plane.area > 0.0f);
        report.grown += plane.area > 0.0f && plane.points > fit.k;
        report.weak += plane.area > 0.0f && plane.error_per_noise * fit.range_noise > kWeak;
    }
    if (report.isolated == planes.size()) throw_degenerate(report);

    hear();
    if (settings.sharp_edges) report.edges = sharpen_edges(points, fit, planes);

    hear();
    const float spacing = median_spacing(planes);
    const Orientation by = find_viewpoints(cloud, settings.trajectory, planes, points, report);
    const OrientationReport sides = orient_normals(points, table, fit.range_noise, planes);
    report.unsure_side = sides.unsure;
    report.facing_inside = sides.of(FreeSideRule::kClosedSide);
    report.facing_outside = sides.of(FreeSideRule::kOpenSide);
    report.orientation = orientation_of(sides, by, at_stations);

    hear();
    const std::vector<float> ndf_lengths =
        estimate_ndf_lengths(points, table, planes, fit.range_noise);
    table.rows = {};

    SurfelCloud surfels{cloud.origin, {}, cloud.stations, cloud.area_lights};
    const std::vector<Rgb8> albedo =
        albedo_bytes(cloud.points, settings.default_albedo, report.albedo);
    write_surfels(cloud, points, planes, ndf_lengths, albedo, fit.range_noise, surfels.surfels,
                  normal_errors);

    hear();
    if (settings.delight) report.delight = delight(surfels);

    report.surfels = surfels.surfels.size();
    report.range_noise = fit.range_noise;
    report.search_radius = fit.radius;
    report.median_spacing = spacing;
    double sum = 0.0;
    for (const Surfel& surfel : surfels.surfels)
        sum += surfel.ndf_length;
    report.mean_ndf_length = sum / static_cast<double>(report.surfels);
    if (report_out) *report_out = report;
    return surfels;
}

}  // namespace glowworm

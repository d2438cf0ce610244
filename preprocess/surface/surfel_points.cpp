#include "preprocess/surface/surfel_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "octree/cloud_summary.h"
#include "octree/error.h"
#include "preprocess/surface/albedo.h"
#include "preprocess/surface/neighbours.h"
#include "preprocess/surface/normals.h"
#include "preprocess/surface/plane_fit.h"

namespace glowworm {
namespace {

/// Points of the ellipse that a missing radius is taken from.
constexpr int kSpacingPoints = 16;

/// Radii ([n] m, in the order of the positions) of discs with the area that each point stands for.
/// Points on a line or alone get the distance to their nearest neighbour, or 0.
std::vector<float> spacing_radii(std::span<const Vec3f> positions) {
    const PointTree tree = make_point_tree(positions);
    std::vector<float> radii(positions.size(), 0.0f);
    constexpr int kOthers = kSpacingPoints - 1;
    for_each_neighbourhood(tree, kOthers, kFarthest, [&](std::uint32_t i, const Neighbours& near) {
        const PlaneFit fit = fit_plane(moments_of(near.x, near.y, near.z, near.size() + 1));
        float& radius = radii[tree.order[i]];
        if (fit.is_planar()) {
            radius = static_cast<float>(std::sqrt(area_per_point(fit) / std::numbers::pi));
        } else if (near.size() > 0) {
            radius = length(Vec3f{near.x[1], near.y[1], near.z[1]});
        }
    });
    return radii;
}

}  // namespace

PointCloud to_points(const SurfelCloud& cloud) {
    PointCloud result{cloud.origin, {}, cloud.stations, cloud.area_lights};
    const std::vector<Surfel>& surfels = cloud.surfels;
    const std::size_t n = surfels.size();
    Points& points = result.points;
    points.positions.reserve(n);
    points.normals.reserve(n);
    points.colours.reserve(n);
    points.ndf_lengths.reserve(n);
    points.radii.reserve(n);
    points.stations.reserve(n);
    const bool emits = std::ranges::any_of(
        surfels, [](const Surfel& surfel) { return surfel.emission != Vec3f{}; });
    if (emits) points.emissions.reserve(n);
    for (const Surfel& surfel : surfels) {
        points.positions.push_back(surfel.position);
        points.normals.push_back(surfel.normal);
        points.colours.push_back(to_srgb(surfel.albedo));
        points.ndf_lengths.push_back(surfel.ndf_length);
        points.radii.push_back(surfel.radius);
        points.stations.push_back(surfel.station);
        if (emits) points.emissions.push_back(surfel.emission);
    }
    return result;
}

Surfel to_surfel(const Points& points, std::size_t i, float radius, const Rgb8& albedo) {
    Surfel surfel;
    surfel.position = points.positions[i];
    const Vec3f& normal = points.normals[i];
    const float l = length(normal);
    // A unit normal is kept to the bit, so that surfels survive the way through a file.
    if (std::isfinite(l) && l > 0.0f) {
        surfel.normal = std::abs(l - 1.0f) < 1e-6f ? normal : normal / l;
    }
    surfel.radius = std::isfinite(radius) ? std::max(radius, 0.0f) : 0.0f;
    if (!points.ndf_lengths.empty() && points.ndf_lengths[i] > 0.0f) {
        surfel.ndf_length = std::min(points.ndf_lengths[i], 1.0f);
    }
    surfel.albedo = to_linear(albedo);
    if (!points.emissions.empty() && is_finite(points.emissions[i])) {
        surfel.emission = component_max(points.emissions[i], Vec3f{});
    }
    if (!points.stations.empty()) surfel.station = points.stations[i];
    return surfel;
}

SurfelCloud to_surfels(const PointCloud& cloud, float default_albedo, SurfelDefaults* defaults) {
    const Points& points = cloud.points;
    if (points.normals.empty()) {
        throw Error(ExitCode::kDegenerate,
                    "The cloud has no normals, which an octree of light needs; run `glowworm "
                    "surface` on it first, or `glowworm convert`, which does it on the way.");
    }
    SurfelDefaults missing{points.ndf_lengths.empty(), points.radii.empty(), points.colours.empty(),
                           0};
    const std::vector<float> radii =
        missing.radius_missing ? spacing_radii(points.positions) : points.radii;
    AlbedoSource source = AlbedoSource::kDefault;
    const std::vector<Rgb8> albedo = albedo_bytes(points, default_albedo, source);

    SurfelCloud result{cloud.origin, {}, cloud.stations, cloud.area_lights};
    result.surfels.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Surfel surfel = to_surfel(points, i, radii[i], albedo[i]);
        if (is_usable(surfel)) result.surfels.push_back(surfel);
    }
    missing.dropped = points.size() - result.surfels.size();
    if (result.surfels.empty()) {
        throw Error(ExitCode::kDegenerate,
                    "None of the " + std::to_string(points.size()) +
                        " points has a finite position and a normal; check the cloud, or run "
                        "`glowworm surface` on it again.");
    }
    if (defaults) *defaults = missing;
    return result;
}

}  // namespace glowworm

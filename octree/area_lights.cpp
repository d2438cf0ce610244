#include "octree/area_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "octree/build.h"
#include "octree/cloud_summary.h"
#include "octree/error.h"

namespace glowworm {
namespace {

constexpr double kTolerance = 0.02;  ///< m

/// A rectangle in the cloud's coordinates: corner + u·edge_u + v·edge_v, u and v in [0, 1].
struct Rectangle {
    Vec3d corner, edge_u, edge_v, normal;
    double area = 0.0;

    bool holds(const Surfel& surfel) const {
        const Vec3d offset = vec3_cast<double>(surfel.position) - corner;
        const auto inside = [&](const Vec3d& edge) {
            const double along = dot(offset, edge) / length(edge);
            return along >= -kTolerance && along <= length(edge) + kTolerance;
        };
        return std::abs(dot(offset, normal)) <= kTolerance && inside(edge_u) && inside(edge_v) &&
               dot(vec3_cast<double>(surfel.normal), normal) > 0.5;
    }
};

Rectangle rectangle_of(const AreaLight& light, const Vec3d& origin) {
    Rectangle r;
    r.corner = light.corners[0] - origin;
    r.edge_u = light.corners[1] - light.corners[0];
    r.edge_v = light.corners[3] - light.corners[0];
    const Vec3d perpendicular = cross(r.edge_u, r.edge_v);
    r.area = length(perpendicular);
    if (!(r.area > 0.0) || !std::isfinite(r.area)) {
        throw Error(ExitCode::kUnreadable,
                    "the area light '" + light.name + "' has no area: check its four corners");
    }
    r.normal = perpendicular / r.area;
    return r;
}

/// Area of the samples that are the light's own.
double tag_samples(std::span<Surfel> surfels, const Rectangle& rectangle, std::uint32_t index,
                   const Vec3f& radiance) {
    double area = 0.0;
    for (Surfel& s : surfels) {
        const bool emits = s.emission.x > 0.0f || s.emission.y > 0.0f || s.emission.z > 0.0f;
        if (!emits || s.light != 0 || !rectangle.holds(s)) continue;
        s.light = index;
        s.emission = radiance;
        area += std::numbers::pi * s.radius * s.radius;
    }
    return area;
}

void add_samples(SurfelCloud& cloud, const Rectangle& rectangle, std::uint32_t index,
                 const Vec3f& radiance, double spacing) {
    const auto steps = [&](double edge) {
        return static_cast<int>(std::clamp(std::ceil(edge / spacing), 4.0, 1000.0));
    };
    const int columns = steps(length(rectangle.edge_u));
    const int rows = steps(length(rectangle.edge_v));
    Surfel s;
    s.normal = vec3_cast<float>(rectangle.normal);
    s.radius = static_cast<float>(std::sqrt(rectangle.area / columns / rows / std::numbers::pi));
    s.emission = radiance;
    s.light = index;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            s.position =
                vec3_cast<float>(rectangle.corner + rectangle.edge_u * ((column + 0.5) / columns) +
                                 rectangle.edge_v * ((row + 0.5) / rows));
            cloud.surfels.push_back(s);
        }
    }
}

}  // namespace

void add_area_lights(SurfelCloud& cloud, std::span<const AreaLight> lights) {
    if (lights.empty()) return;
    fill_missing_radii(cloud);
    const CloudSummary summary = summarize(cloud.surfels);
    const double spacing = summary.median_radius > 0.0 ? summary.median_spacing() : kTolerance;
    for (const AreaLight& light : lights) {
        const Rectangle rectangle = rectangle_of(light, cloud.origin);
        cloud.area_lights.push_back(light);
        const auto index = static_cast<std::uint32_t>(cloud.area_lights.size());
        const double there = tag_samples(cloud.surfels, rectangle, index, light.radiance);
        if (there < 0.5 * rectangle.area) {
            add_samples(cloud, rectangle, index, light.radiance, spacing);
        }
    }
}

}  // namespace glowworm

#include "octree/area_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

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

/// A light under its own index.
struct TaggedLight {
    Rectangle rectangle;
    std::uint32_t index;
    Vec3f radiance;
};

/// The lights as they will be called after the `before` that are there already.
std::vector<TaggedLight> tagged(std::span<const AreaLight> lights, const Vec3d& origin,
                                std::size_t before) {
    std::vector<TaggedLight> out;
    for (const AreaLight& light : lights) {
        out.push_back(
            {rectangle_of(light, origin), static_cast<std::uint32_t>(++before), light.radiance});
    }
    return out;
}

/// Gives samples that are a light's own its index and radiance. `area`: [lights] m², added to.
void tag_samples(std::span<Surfel> surfels, std::span<const TaggedLight> lights,
                 std::span<double> area) {
    for (Surfel& s : surfels) {
        const bool emits = s.emission.x > 0.0f || s.emission.y > 0.0f || s.emission.z > 0.0f;
        if (!emits || s.light != 0) continue;
        for (std::size_t i = 0; i < lights.size(); ++i) {
            if (!lights[i].rectangle.holds(s)) continue;
            s.light = lights[i].index;
            s.emission = lights[i].radiance;
            area[i] += std::numbers::pi * s.radius * s.radius;
            break;
        }
    }
}

void add_samples(const TaggedLight& light, double spacing, std::vector<Surfel>& surfels) {
    const Rectangle& rectangle = light.rectangle;
    const auto steps = [&](double edge) {
        return static_cast<int>(std::clamp(std::ceil(edge / spacing), 4.0, 1000.0));
    };
    const int columns = steps(length(rectangle.edge_u));
    const int rows = steps(length(rectangle.edge_v));
    Surfel s;
    s.normal = vec3_cast<float>(rectangle.normal);
    s.radius = static_cast<float>(std::sqrt(rectangle.area / columns / rows / std::numbers::pi));
    s.emission = light.radiance;
    s.light = light.index;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            s.position =
                vec3_cast<float>(rectangle.corner + rectangle.edge_u * ((column + 0.5) / columns) +
                                 rectangle.edge_v * ((row + 0.5) / rows));
            surfels.push_back(s);
        }
    }
}

/// Samples for the lights that `area` [lights] of a cloud's own covers less than half of.
std::vector<Surfel> missing_samples(std::span<const TaggedLight> lights,
                                    std::span<const double> area, const CloudSummary& summary) {
    const double spacing = summary.median_radius > 0.0 ? summary.median_spacing() : kTolerance;
    std::vector<Surfel> samples;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (area[i] < 0.5 * lights[i].rectangle.area) add_samples(lights[i], spacing, samples);
    }
    return samples;
}

}  // namespace

void add_area_lights(SurfelCloud& cloud, std::span<const AreaLight> lights) {
    if (lights.empty()) return;
    fill_missing_radii(cloud);
    const CloudSummary summary = summarize(cloud.surfels);
    const auto rectangles = tagged(lights, cloud.origin, cloud.area_lights.size());
    std::vector<double> area(lights.size(), 0.0);
    tag_samples(cloud.surfels, rectangles, area);
    const std::vector<Surfel> samples = missing_samples(rectangles, area, summary);
    cloud.surfels.insert(cloud.surfels.end(), samples.begin(), samples.end());
    cloud.area_lights.insert(cloud.area_lights.end(), lights.begin(), lights.end());
}

SurfelStream with_area_lights(SurfelStream stream, std::span<const AreaLight> lights) {
    if (lights.empty()) return stream;
    const auto rectangles = tagged(lights, stream.origin, stream.area_lights.size());
    // A missing radius is filled in before samples of another kind join: see fill_missing_radii.
    CloudSummarizer summarizer;
    std::vector<Surfel> batch;
    stream.for_each([&](std::span<const Surfel> surfels) { summarizer.add(surfels); });
    const CloudSummary summary = summarizer.finish();
    const auto tag = [rectangles, radius = summary.radius_missing ? summary.median_radius : 0.0](
                         std::span<Surfel> surfels, std::span<double> area) {
        for (Surfel& s : surfels) {
            if (radius > 0.0 && is_usable(s)) repair(s, radius);
        }
        tag_samples(surfels, rectangles, area);
    };

    std::vector<double> area(lights.size(), 0.0);
    stream.for_each([&](std::span<const Surfel> surfels) {
        batch.assign(surfels.begin(), surfels.end());
        tag(batch, area);
    });
    const std::vector<Surfel> samples = missing_samples(rectangles, area, summary);
    SurfelStream lit = stream;
    lit.area_lights.insert(lit.area_lights.end(), lights.begin(), lights.end());
    if (lit.expected > 0) lit.expected += samples.size();
    lit.for_each = [unlit = stream.for_each, tag, samples,
                    count = lights.size()](const auto& visit) {
        std::vector<double> ignored(count, 0.0);
        std::vector<Surfel> tagged_batch;
        unlit([&](std::span<const Surfel> surfels) {
            tagged_batch.assign(surfels.begin(), surfels.end());
            tag(tagged_batch, ignored);
            visit(tagged_batch);
        });
        if (!samples.empty()) visit(samples);
    };
    return lit;
}

}  // namespace glowworm

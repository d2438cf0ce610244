#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "preprocess/surface/normals.h"
#include "preprocess/surface/plane_fit.h"

namespace glowworm {
namespace {

/// A neighbourhood this much thicker than the noise, and than this share of its extent, is bent too
/// sharply for one plane: a fold by more than some 30 degrees.
constexpr float kThickerThanNoise = 2.5f;
constexpr float kThicknessOfExtent = 0.14f;

bool crosses_edge(const LocalPlane& plane, float noise) {
    const float extent2 =
        plane.area * static_cast<float>(plane.points) / (4.0f * std::numbers::pi_v<float>);
    return plane.area > 0.0f && plane.thickness > kThickerThanNoise * noise &&
           plane.thickness * plane.thickness > kThicknessOfExtent * kThicknessOfExtent * extent2;
}

/// Tukey's biweight: 1 on the plane, 0 from `reach` on.
double biweight(double distance, double reach) {
    const double u = distance / reach;
    const double v = 1.0 - u * u;
    return v > 0.0 ? v * v : 0.0;
}

LocalPlane fit_one_side(const SurfacePoints& points, std::size_t i, const NormalSettings& settings,
                        const NeighbourTable& table, const std::vector<LocalPlane>& planes) {
    const Vec3f origin = points.tree.position(i);
    const auto neighbours = table.of(i);

    // The flattest plane around that the point lies in.
    const LocalPlane* best = &planes[i];
    Vec3d normal = vec3_cast<double>(planes[i].normal);
    double offset = planes[i].height;
    double best_cost = planes[i].thickness * planes[i].thickness + offset * offset;
    for (const std::uint32_t j : neighbours) {
        if (!(planes[j].area > 0.0f)) continue;
        const Vec3d n = vec3_cast<double>(planes[j].normal);
        const double distance =
            dot(n, vec3_cast<double>(points.tree.position(j) - origin)) + planes[j].height;
        const double cost = planes[j].thickness * planes[j].thickness + distance * distance;
        if (cost < best_cost) {
            best_cost = cost;
            best = &planes[j];
            normal = n;
            offset = distance;
        }
    }

    const double scale = std::max(settings.range_noise, best->thickness);
    const double reach = std::max(4.0 * scale, 1e-9);
    PlaneFit fit;
    for (int step = 0; step < 4; ++step) {
        Moments moments;
        moments.add({}, biweight(offset, reach));
        for (const std::uint32_t j : neighbours) {
            const Vec3d p = vec3_cast<double>(points.tree.position(j) - origin);
            moments.add(p, biweight(dot(normal, p) - offset, reach));
        }
        fit = fit_plane(moments);
        if (!fit.is_planar() || fit.weight < 4.0) return {};
        normal = fit.normal;
        offset = dot(fit.normal, fit.centre);
    }
    if (std::abs(offset) > reach) return {};

    Moments side;
    side.add({});
    for (const std::uint32_t j : neighbours) {
        const Vec3d p = vec3_cast<double>(points.tree.position(j) - origin);
        if (std::abs(dot(normal, p) - offset) < reach) side.add(p);
    }
    const PlaneFit extent = fit_plane(side);
    LocalPlane plane;
    plane.normal = vec3_cast<float>(normal);
    plane.height = static_cast<float>(offset);
    plane.thickness = static_cast<float>(
        std::sqrt(fit.thickness2 * fit.weight / std::max(fit.weight - 3.0, 1.0)));
    plane.error_per_noise = static_cast<float>(fit.angle_error_per_noise());
    plane.area = static_cast<float>(area_per_point(extent));
    plane.points = static_cast<std::uint16_t>(extent.weight);
    plane.edge = true;
    return plane;
}

}  // namespace

std::size_t sharpen_edges(const SurfacePoints& points, const NormalSettings& settings,
                          const NeighbourTable& table, std::vector<LocalPlane>& planes) {
    std::vector<std::uint32_t> candidates;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        if (crosses_edge(planes[i], settings.range_noise)) {
            candidates.push_back(static_cast<std::uint32_t>(i));
        }
    }
    // Read all before writing any, so that the order of the threads does not show.
    std::vector<LocalPlane> sharp(candidates.size());
    tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t c) {
        sharp[c] = fit_one_side(points, candidates[c], settings, table, planes);
    });
    std::size_t fitted = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        if (!sharp[c].edge) continue;
        planes[candidates[c]] = sharp[c];
        ++fitted;
    }
    return fitted;
}

}  // namespace glowworm

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>
#include <vector>

#include "preprocess/surface/surface.h"
#include "surface/shapes.h"

namespace glowworm::testing {

/// How well surfels match the truth.
struct Accuracy {
    double median_deg = 0.0, p95_deg = 0.0;  ///< angle between the lines of the normals
    double right_side = 0.0;                 ///< share of normals on the true side
    double area = 0.0;                       ///< m²: sum of the surfels' discs
};

/// Compares surfels with true normals ([n], in the surfels' order).
inline Accuracy compare(std::span<const Surfel> surfels, std::span<const Vec3f> truth) {
    Accuracy accuracy;
    std::vector<double> angles;
    std::size_t right = 0;
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        const double c = dot(vec3_cast<double>(surfels[i].normal), vec3_cast<double>(truth[i]));
        right += c > 0.0;
        angles.push_back(std::acos(std::min(std::abs(c), 1.0)) * 180.0 / std::numbers::pi);
        accuracy.area += std::numbers::pi * surfels[i].radius * surfels[i].radius;
    }
    std::ranges::sort(angles);
    accuracy.median_deg = angles[angles.size() / 2];
    accuracy.p95_deg = angles[angles.size() * 95 / 100];
    accuracy.right_side = static_cast<double>(right) / static_cast<double>(surfels.size());
    return accuracy;
}

/// The normals of the points that became surfels: the others were left out, the order stayed.
inline std::vector<Vec3f> truth_of(std::span<const Surfel> surfels, const Shape& shape) {
    std::vector<Vec3f> truth;
    std::size_t next = 0;
    for (const Surfel& surfel : surfels) {
        while (!(shape.cloud.points.positions[next] == surfel.position))
            ++next;
        truth.push_back(shape.normals[next++]);
    }
    return truth;
}

inline void print(const char* what, const Accuracy& a, const SurfaceReport& report) {
    std::printf(
        "%-28s median %.2f deg, 95 %% %.2f deg, right side %.3f %%, noise %.2f mm, "
        "edges %zu, grown %zu, isolated %zu, unsure %zu, ndf %.4f, spacing %.1f mm\n",
        what, a.median_deg, a.p95_deg, 100.0 * a.right_side, 1e3 * report.range_noise, report.edges,
        report.grown, report.isolated, report.unsure_side, report.mean_ndf_length,
        1e3 * report.median_spacing);
}

}  // namespace glowworm::testing

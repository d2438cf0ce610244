#pragma once

#include <cstddef>

#include "octree/vec3.h"

namespace glowworm {

/// Weighted sums of points up to second order, relative to some nearby place.
struct Moments {
    double weight = 0.0;
    Vec3d sum;
    double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

    void add(const Vec3d& p, double w = 1.0) {
        const Vec3d q = p * w;
        weight += w;
        sum += q;
        xx += q.x * p.x;
        xy += q.x * p.y;
        xz += q.x * p.z;
        yy += q.y * p.y;
        yz += q.y * p.z;
        zz += q.z * p.z;
    }
};

/// Moments of points ([count] each, m), summed in four lanes: the same bits on every processor.
Moments moments_of(const float* x, const float* y, const float* z, std::size_t count);

/// The plane of least squares through points: their principal components.
struct PlaneFit {
    Vec3d centre;             ///< m, weighted mean
    Vec3d normal;             ///< unit, of either sign; across the line for points on one
    double thickness2 = 0.0;  ///< m²: variance along the normal, the smallest eigenvalue
    double width2 = 0.0;      ///< m²: the middle eigenvalue
    double length2 = 0.0;     ///< m²: the largest eigenvalue
    double weight = 0.0;      ///< sum of weights

    /// The points spread in two directions, so the plane is more than a guess: width at least a
    /// tenth of length and clear of the thickness.
    bool is_planar() const {
        return width2 > 0.01 * length2 && width2 > 1.5 * thickness2 && weight > 2.5;
    }

    /// m²: area of the ellipse that has these moments when it is evenly filled; of a half disc, as
    /// at a border, it says 1.06 times the area where the k-th distance would say twice.
    double area() const;

    /// 1/m: times the standard deviation of the points along the normal (m) it is the standard
    /// error of the normal's angle, rad, both tilts together.
    double angle_error_per_noise() const;
};

/// Eigenvalues without trigonometry: only operations that IEEE 754 rounds exactly, so every host
/// gives the same bits. A zero weight gives all zero.
PlaneFit fit_plane(const Moments& moments);

}  // namespace glowworm

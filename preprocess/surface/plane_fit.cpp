#include "preprocess/surface/plane_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace glowworm {
namespace {

struct Covariance {
    double xx, xy, xz, yy, yz, zz;
};

/// The smallest root of the characteristic polynomial of `c`, whose trace is 1. Newton's method
/// from 0, which lies below it: there the polynomial is concave and rising, so no step overshoots.
double smallest_eigenvalue(const Covariance& c) {
    const double minors =
        c.xx * c.yy - c.xy * c.xy + c.xx * c.zz - c.xz * c.xz + c.yy * c.zz - c.yz * c.yz;
    const double determinant = c.xx * (c.yy * c.zz - c.yz * c.yz) -
                               c.xy * (c.xy * c.zz - c.yz * c.xz) +
                               c.xz * (c.xy * c.yz - c.yy * c.xz);
    double root = 0.0;
    for (int step = 0; step < 40; ++step) {
        const double value = ((root - 1.0) * root + minors) * root - determinant;
        const double slope = (3.0 * root - 2.0) * root + minors;
        if (!(value < 0.0) || !(slope > 1e-14)) break;
        const double next = std::min(root - value / slope, 1.0 / 3.0);
        if (next - root <= 1e-12 * next) return next;
        root = next;
    }
    return std::clamp(root, 0.0, 1.0 / 3.0);
}

/// The direction that `c` - value·1 maps to zero: the longest cross product of two of its rows.
/// Zero where the eigenvalue is double.
Vec3d eigenvector(const Covariance& c, double value) {
    const Vec3d rows[3] = {
        {c.xx - value, c.xy, c.xz}, {c.xy, c.yy - value, c.yz}, {c.xz, c.yz, c.zz - value}};
    const Vec3d products[3] = {cross(rows[0], rows[1]), cross(rows[0], rows[2]),
                               cross(rows[1], rows[2])};
    const Vec3d* longest = &products[0];
    for (const Vec3d& product : products) {
        if (dot(product, product) > dot(*longest, *longest)) longest = &product;
    }
    const double l2 = dot(*longest, *longest);
    return l2 > 1e-24 ? *longest / std::sqrt(l2) : Vec3d{};
}

/// Some unit vector across the longest row of `c`, for points on a line or in a ball.
Vec3d across(const Covariance& c) {
    const Vec3d rows[3] = {{c.xx, c.xy, c.xz}, {c.xy, c.yy, c.yz}, {c.xz, c.yz, c.zz}};
    const Vec3d* longest = &rows[0];
    for (const Vec3d& row : rows) {
        if (dot(row, row) > dot(*longest, *longest)) longest = &row;
    }
    const Vec3d a{std::abs(longest->x), std::abs(longest->y), std::abs(longest->z)};
    const Vec3d axis = a.x <= a.y && a.x <= a.z ? Vec3d{1, 0, 0}
                       : a.y <= a.z             ? Vec3d{0, 1, 0}
                                                : Vec3d{0, 0, 1};
    return normalized(cross(*longest, axis));
}

}  // namespace

double PlaneFit::area() const {
    return 4.0 * std::numbers::pi * std::sqrt(std::max(width2, 0.0) * std::max(length2, 0.0));
}

double PlaneFit::angle_error_per_noise() const {
    if (!(width2 > 0.0) || !(weight > 0.0)) return 1e30;
    return std::sqrt((1.0 / width2 + 1.0 / length2) / weight);
}

PlaneFit fit_plane(const Moments& m) {
    PlaneFit fit;
    fit.weight = m.weight;
    if (!(m.weight > 0.0)) return fit;
    fit.centre = m.sum / m.weight;
    const Vec3d& c = fit.centre;
    const Covariance raw{m.xx / m.weight - c.x * c.x, m.xy / m.weight - c.x * c.y,
                         m.xz / m.weight - c.x * c.z, m.yy / m.weight - c.y * c.y,
                         m.yz / m.weight - c.y * c.z, m.zz / m.weight - c.z * c.z};
    const double trace = raw.xx + raw.yy + raw.zz;
    if (!(trace > 1e-30)) return fit;
    const Covariance unit{raw.xx / trace, raw.xy / trace, raw.xz / trace,
                          raw.yy / trace, raw.yz / trace, raw.zz / trace};
    const double smallest = smallest_eigenvalue(unit);
    // The other two from their sum and the sum of squares of all entries.
    const double sum = 1.0 - smallest;
    const double squares = unit.xx * unit.xx + unit.yy * unit.yy + unit.zz * unit.zz +
                           2.0 * (unit.xy * unit.xy + unit.xz * unit.xz + unit.yz * unit.yz) -
                           smallest * smallest;
    const double half_gap = std::sqrt(std::max(2.0 * squares - sum * sum, 0.0)) / 2.0;
    fit.thickness2 = trace * smallest;
    fit.length2 = trace * (sum / 2.0 + half_gap);
    fit.width2 = std::max(trace * (sum / 2.0 - half_gap), fit.thickness2);
    fit.normal = eigenvector(unit, smallest);
    if (fit.normal == Vec3d{}) fit.normal = across(unit);
    return fit;
}

}  // namespace glowworm

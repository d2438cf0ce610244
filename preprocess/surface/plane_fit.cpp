#include "preprocess/surface/plane_fit.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

// No fused operations (-ffp-contract=off), so every clone gives the same bits. The sanitizers start
// too late for the choice at load time.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__)
#define GLOWWORM_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define GLOWWORM_WIDE
#endif

namespace glowworm {
namespace {

struct Covariance {
    double xx, xy, xz, yy, yz, zz;
};

/// The smallest root of the characteristic polynomial of `c`, whose trace is 1. Halley's method
/// from 0, which lies below it: of a polynomial whose roots are all real no step overshoots there.
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
        const double bend = 3.0 * root - 1.0;  // half the second derivative
        if (!(value < 0.0) || !(slope > 1e-14)) break;
        const double next =
            std::min(root - value * slope / (slope * slope - value * bend), 1.0 / 3.0);
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

GLOWWORM_WIDE
Moments moments_of(const float* x, const float* y, const float* z, std::size_t count) {
    using Floats [[gnu::vector_size(16)]] = float;
    using Lanes [[gnu::vector_size(32)]] = double;
    Lanes sx{}, sy{}, sz{}, xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
    float rest[3][4] = {};  // what is left of four, and zeros
    for (std::size_t i = 0; i < count; i += 4, x += 4, y += 4, z += 4) {
        if (count - i < 4) {
            x = std::copy_n(x, count - i, rest[0]) - (count - i);
            y = std::copy_n(y, count - i, rest[1]) - (count - i);
            z = std::copy_n(z, count - i, rest[2]) - (count - i);
        }
        Floats fx, fy, fz;
        std::memcpy(&fx, x, sizeof fx);
        std::memcpy(&fy, y, sizeof fy);
        std::memcpy(&fz, z, sizeof fz);
        const Lanes px = __builtin_convertvector(fx, Lanes);
        const Lanes py = __builtin_convertvector(fy, Lanes);
        const Lanes pz = __builtin_convertvector(fz, Lanes);
        sx += px;
        sy += py;
        sz += pz;
        xx += px * px;
        xy += px * py;
        xz += px * pz;
        yy += py * py;
        yz += py * pz;
        zz += pz * pz;
    }
    const auto total = [](const double* lane) { return (lane[0] + lane[1]) + (lane[2] + lane[3]); };
    Moments moments;
    moments.weight = static_cast<double>(count);
    alignas(32) double sums[9][4];
    const Lanes lanes[9] = {sx, sy, sz, xx, xy, xz, yy, yz, zz};
    std::memcpy(sums, lanes, sizeof sums);
    moments.sum = {total(sums[0]), total(sums[1]), total(sums[2])};
    moments.xx = total(sums[3]);
    moments.xy = total(sums[4]);
    moments.xz = total(sums[5]);
    moments.yy = total(sums[6]);
    moments.yz = total(sums[7]);
    moments.zz = total(sums[8]);
    return moments;
}

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

#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "preprocess/scan.h"

namespace glowworm::testing {

struct Sphere {
    Eigen::Vector3d centre;
    double radius;
};

/// A cave as the union of air-filled spheres: no plane in it, like the real ones. `solid` spheres
/// stand in the air (people, boulders).
struct SimulatedCave {
    std::vector<Sphere> air;
    std::vector<Sphere> solid;

    /// How far one can see from `from` (inside the air) toward unit `direction`, m.
    double range(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
        struct Interval {
            double begin, end;
        };
        std::vector<Interval> inside;
        double stop = 1e9;
        const auto cross = [&](const Sphere& s, Interval& out) {
            const Eigen::Vector3d d = from - s.centre;
            const double b = d.dot(direction), c = d.squaredNorm() - s.radius * s.radius;
            const double root = b * b - c;
            if (root <= 0.0) return false;
            out = {-b - std::sqrt(root), -b + std::sqrt(root)};
            return out.end > 0.0;
        };
        for (const Sphere& s : air) {
            Interval interval;
            if (cross(s, interval)) inside.push_back(interval);
        }
        for (const Sphere& s : solid) {
            Interval interval;
            if (cross(s, interval) && interval.begin > 0.0) stop = std::min(stop, interval.begin);
        }
        std::sort(inside.begin(), inside.end(),
                  [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
        double reached = 0.0;
        for (const Interval& i : inside) {
            if (i.begin > reached) break;
            reached = std::max(reached, i.end);
        }
        return std::min(reached, stop);
    }
};

/// A chamber of about ten metres with alcoves and bowls of all sizes, seeded, around `centre`.
inline void add_chamber(SimulatedCave& cave, const Eigen::Vector3d& centre, unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    cave.air.push_back({centre, 2.0});
    for (int i = 0; i < 45; ++i) {
        const Eigen::Vector3d off(3.8 * unit(rng), 3.8 * unit(rng), 1.4 * unit(rng));
        cave.air.push_back({centre + off, 0.7 + 0.9 * std::abs(unit(rng))});
    }
}

/// A winding passage from `from` to `to`.
inline void add_passage(SimulatedCave& cave, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                        unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const int steps = static_cast<int>((to - from).norm() / 0.4) + 1;
    for (int i = 0; i <= steps; ++i) {
        const Eigen::Vector3d at = from + (to - from) * i / steps;
        cave.air.push_back(
            {at + 0.4 * Eigen::Vector3d(unit(rng), unit(rng), unit(rng)), 0.9 + 0.3 * unit(rng)});
    }
}

/// Two chambers and a passage between them.
inline SimulatedCave two_chambers(unsigned seed = 1) {
    SimulatedCave cave;
    add_chamber(cave, {0, 0, 0}, seed);
    add_passage(cave, {2, 0, 0}, {11, 2, 0.5}, seed + 1);
    add_chamber(cave, {13, 2, 0.5}, seed + 2);
    return cave;
}

/// What a scanner at `T_world_scan` sees: `points` rays spread evenly (a Fibonacci sphere), range
/// noise of `noise` metres. Yaw and tilt are in the pose.
inline Scan scan_cave(const SimulatedCave& cave, const Eigen::Isometry3d& T_world_scan,
                      std::size_t points, unsigned seed, double noise = 0.003) {
    std::mt19937 rng(seed);
    std::normal_distribution<double> error(0.0, noise);
    Scan scan;
    scan.name = "scan" + std::to_string(seed);
    scan.file = scan.name;
    scan.has_viewpoint = true;
    for (std::size_t i = 0; i < points; ++i) {
        const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(points);
        const double angle = 2.399963229728653 * static_cast<double>(i);
        const double q = std::sqrt(1.0 - z * z);
        const Eigen::Vector3d direction(q * std::cos(angle), q * std::sin(angle), z);
        const double range =
            cave.range(T_world_scan.translation(), T_world_scan.rotation() * direction) +
            error(rng);
        const Eigen::Vector3f p = (range * direction).cast<float>();
        scan.points.positions.push_back({p.x(), p.y(), p.z()});
    }
    return scan;
}

/// A pose at `place`, turned by a seeded yaw and tilted by up to 3°.
inline Eigen::Isometry3d station_at(const Eigen::Vector3d& place, unsigned seed,
                                    double tilt = 0.05) {
    std::mt19937 rng(seed + 1000);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = (Eigen::AngleAxisd(3.1 * unit(rng), Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(tilt * unit(rng), Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
    T.translation() = place;
    return T;
}

/// How far two poses are apart.
struct PoseError {
    double degrees, millimetres;
};
inline PoseError pose_error(const Eigen::Isometry3d& found, const Eigen::Isometry3d& truth) {
    const Eigen::Isometry3d E = truth.inverse() * found;
    return {Eigen::AngleAxisd(E.rotation()).angle() * 57.29577951308232,
            1000.0 * E.translation().norm()};
}

}  // namespace glowworm::testing

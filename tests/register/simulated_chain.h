#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "simulated_cave.h"

namespace glowworm::testing {

/// Stations one behind the other in a passage.
struct Chain {
    std::vector<Scan> scans;
    std::vector<Eigen::Isometry3d> truth;  ///< T_world_scan
};

struct ChainSettings {
    std::size_t stations = 12;
    std::size_t points = 10000;  ///< per scan
    double apart = 3.0;          ///< m, from station to station
    double radius = 0.9;         ///< m, of the passage
    double noise = 0.003;        ///< m, of a range
    double reach = 15.0;         ///< m, of the scanner
};

/// A passage that winds but never meets itself, seen from stations along it.
inline Chain chain_of_stations(const ChainSettings& settings, unsigned seed) {
    constexpr double kStep = 0.4;  // m, between the passage's spheres
    std::mt19937 rng(seed * 7919 + 13);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    SimulatedCave cave;
    std::vector<Eigen::Vector3d> path;
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    double yaw = 0.0, pitch = 0.0, yaw_rate = 0.0, pitch_rate = 0.0;
    const double length = settings.apart * static_cast<double>(settings.stations + 1);
    for (int i = 0; i < static_cast<int>(length / kStep); ++i) {
        const Eigen::Vector3d off(0.4 * unit(rng), 0.4 * unit(rng), 0.4 * unit(rng));
        cave.air.push_back({at + off, settings.radius * (1.0 + 0.33 * unit(rng))});
        path.push_back(at);
        yaw_rate = 0.8 * yaw_rate + 0.12 * unit(rng);
        pitch_rate = 0.8 * pitch_rate + 0.05 * unit(rng);
        yaw = 0.985 * yaw + yaw_rate;
        pitch = 0.95 * pitch + pitch_rate;
        at += kStep * Eigen::Vector3d(std::cos(yaw) * std::cos(pitch),
                                      std::sin(yaw) * std::cos(pitch), std::sin(pitch));
    }
    Chain chain;
    for (std::size_t s = 0; s < settings.stations; ++s) {
        const double along = settings.apart * (static_cast<double>(s) + 0.5);
        const Eigen::Vector3d place = path[static_cast<std::size_t>(along / kStep)];
        SimulatedCave near;
        for (const Sphere& sphere : cave.air) {
            if ((sphere.centre - place).norm() < settings.reach + 2.0) near.air.push_back(sphere);
        }
        const unsigned own = seed * 1000 + static_cast<unsigned>(s);
        chain.truth.push_back(station_at(place, own));
        Scan scan = scan_cave(near, chain.truth.back(), settings.points, own, settings.noise);
        std::erase_if(scan.points.positions, [&](const Vec3f& p) {
            return !(static_cast<double>(glowworm::length(p)) < settings.reach);
        });
        scan.file = scan.name = "station" + std::to_string(s + 1);
        chain.scans.push_back(std::move(scan));
    }
    return chain;
}

}  // namespace glowworm::testing

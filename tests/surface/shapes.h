#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include "preprocess/points.h"

namespace glowworm::testing {

/// Numbers that are the same on every host: SplitMix64 (Steele et al. 2014).
class Random {
  public:
    explicit Random(std::uint64_t seed = 1) : state_(seed) {}
    double uniform() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
    }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    double gauss() {
        return std::sqrt(-2.0 * std::log(1.0 - uniform())) *
               std::cos(2.0 * std::numbers::pi * uniform());
    }
    Vec3d direction() {
        const double z = uniform(-1.0, 1.0), phi = uniform(0.0, 2.0 * std::numbers::pi);
        const double r = std::sqrt(1.0 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

  private:
    std::uint64_t state_;
};

/// A cloud and what is true of it.
struct Shape {
    PointCloud cloud;
    std::vector<Vec3f> normals;  ///< [n] true, toward the free side
    double area = 0.0;           ///< m², of the whole surface
};

inline void add_point(Shape& shape, const Vec3d& position, const Vec3d& normal,
                      std::uint32_t station = 0) {
    shape.cloud.points.positions.push_back(vec3_cast<float>(position));
    shape.cloud.points.stations.push_back(station);
    shape.normals.push_back(vec3_cast<float>(normal));
}

inline Station station_at(const Vec3d& position, bool has_viewpoint = true) {
    Station station;
    station.position = position;
    station.has_viewpoint = has_viewpoint;
    station.name = "simulated";
    return station;
}

/// Moves every point along its true normal by Gaussian noise of `sigma` metres.
inline void add_noise(Shape& shape, double sigma, std::uint64_t seed = 7) {
    Random random(seed);
    for (std::size_t i = 0; i < shape.normals.size(); ++i) {
        shape.cloud.points.positions[i] +=
            shape.normals[i] * static_cast<float>(sigma * random.gauss());
    }
}

/// A square of `edge` metres in z = 0, seen from above its middle.
inline Shape make_wall(int n, double edge) {
    Shape shape;
    Random random;
    for (int i = 0; i < n; ++i) {
        add_point(shape, {random.uniform(0, edge), random.uniform(0, edge), 0}, {0, 0, 1});
    }
    shape.cloud.stations = {station_at({edge / 2, edge / 2, 2.0})};
    shape.area = edge * edge;
    return shape;
}

/// A sphere seen from a little off its middle.
inline Shape make_sphere(int n, double radius) {
    Shape shape;
    Random random;
    for (int i = 0; i < n; ++i) {
        const Vec3d d = random.direction();
        add_point(shape, d * radius, -d);
    }
    shape.cloud.stations = {station_at({0.3 * radius, 0.1 * radius, 0})};
    shape.area = 4.0 * std::numbers::pi * radius * radius;
    return shape;
}

/// A straight tube along x, open at both ends, seen from its middle.
inline Shape make_tube(int n, double radius, double length) {
    Shape shape;
    Random random;
    for (int i = 0; i < n; ++i) {
        const double phi = random.uniform(0.0, 2.0 * std::numbers::pi);
        const Vec3d d{0, std::cos(phi), std::sin(phi)};
        add_point(shape, d * radius + Vec3d{random.uniform(0, length), 0, 0}, -d);
    }
    shape.cloud.stations = {station_at({length / 2, 0.2 * radius, 0})};
    shape.area = 2.0 * std::numbers::pi * radius * length;
    return shape;
}

/// The inside of a cube of edge 2 m about the world's origin, seen from near its middle.
inline Shape make_room(int n) {
    Shape shape;
    Random random;
    for (int i = 0; i < n; ++i) {
        const int face = static_cast<int>(random.uniform(0.0, 6.0));
        Vec3d p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        Vec3d normal{};
        p[face / 2] = face % 2 ? 1.0 : -1.0;
        normal[face / 2] = -p[face / 2];
        add_point(shape, p, normal);
    }
    shape.cloud.stations = {station_at({0.2, -0.1, 0.15})};
    shape.area = 24.0;
    return shape;
}

/// A sheet of 1 m by 1 m and `thickness` metres across y, each side seen by its own station.
inline Shape make_curtain(int n, double thickness) {
    Shape shape;
    Random random;
    for (int i = 0; i < n; ++i) {
        const bool back = i % 2;
        const double side = back ? -1.0 : 1.0;
        add_point(shape, {random.uniform(), side * thickness / 2, random.uniform()}, {0, side, 0},
                  back);
    }
    shape.cloud.stations = {station_at({0.5, 3.0, 0.5}), station_at({0.4, -3.0, 0.6})};
    shape.area = 2.0;
    return shape;
}

}  // namespace glowworm::testing

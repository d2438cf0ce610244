#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "octree/surfel.h"

namespace glowworm::testing {

inline Surfel surfel_at(const Vec3f& position, const Vec3f& normal, float radius) {
    Surfel s;
    s.position = position;
    s.normal = normal;
    s.radius = radius;
    s.albedo = {0.5f, 0.4f, 0.3f};
    return s;
}

template <typename Random>
Vec3f random_direction(Random& random) {
    std::normal_distribution<float> gauss;
    return normalized(Vec3f{gauss(random), gauss(random), gauss(random)});
}

/// Points all over a cube, with everything varied that a surfel has.
inline SurfelCloud random_cloud(std::size_t count, float radius, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    SurfelCloud cloud;
    cloud.origin = {100.0, 200.0, 300.0};
    for (int i = 0; i < 3; ++i) {
        Station station;
        station.position = {1.0 * i, 2.0, 3.0};
        station.name = "station " + std::to_string(i);
        cloud.stations.push_back(station);
    }
    AreaLight light;
    light.name = "lamp";
    light.corners[1] = {1, 0, 0};
    light.corners[2] = {1, 1, 0};
    light.corners[3] = {0, 1, 0};
    light.radiance = {3, 2, 1};
    cloud.area_lights.push_back(light);
    for (std::size_t i = 0; i < count; ++i) {
        Surfel s = surfel_at({unit(random) * 4 - 2, unit(random) * 4 - 2, unit(random) * 4 - 2},
                             random_direction(random), radius * (0.5f + unit(random)));
        s.ndf_length = 0.2f + 0.8f * unit(random);
        s.albedo = {unit(random), unit(random), unit(random)};
        s.station = static_cast<std::uint32_t>(i % 3);
        if (i % 50 == 0) {
            s.light = 1;
            s.emission = {3, 2, 1};
        }
        cloud.surfels.push_back(s);
    }
    return cloud;
}

/// A sphere of radius 2 m seen from inside, even by area (Fibonacci).
inline SurfelCloud sphere_cloud(std::size_t count) {
    SurfelCloud cloud;
    cloud.stations.resize(1);
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        const double r = std::sqrt(1.0 - z * z);
        const double angle = golden * static_cast<double>(i);
        const Vec3f d = vec3_cast<float>(Vec3d{r * std::cos(angle), r * std::sin(angle), z});
        cloud.surfels.push_back(
            surfel_at(d * 2.0f, -d, 4.0f / std::sqrt(static_cast<float>(count))));
    }
    return cloud;
}

}  // namespace glowworm::testing

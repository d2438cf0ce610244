#pragma once

#include <cmath>
#include <cstdint>

#include "octree/scene.h"
#include "octree/surfel.h"

namespace glowworm::testing {

/// Surfels on a rectangle that faces along `normal_sign` of `axis`, jittered on a grid of `spacing`
/// m.
inline void add_wall(SurfelCloud& cloud, int axis, float place, float normal_sign, Vec3f low,
                     Vec3f high, float spacing) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::uint32_t state = static_cast<std::uint32_t>(cloud.surfels.size()) * 2654435761u + 1u;
    const auto random = [&] {
        state = state * 1664525u + 1013904223u;
        return static_cast<float>(state >> 8) / 16777216.0f;
    };
    for (float a = low[u]; a < high[u]; a += spacing) {
        for (float b = low[v]; b < high[v]; b += spacing) {
            Surfel surfel;
            surfel.position[axis] = place;
            surfel.position[u] = std::min(a + spacing * random(), high[u]);
            surfel.position[v] = std::min(b + spacing * random(), high[v]);
            surfel.normal[axis] = normal_sign;
            surfel.radius = 0.5642f * spacing;  // sqrt(1 / pi)
            surfel.albedo = {0.5f, 0.5f, 0.5f};
            cloud.surfels.push_back(surfel);
        }
    }
}

/// The inside of a box.
inline SurfelCloud closed_room(Vec3f low, Vec3f high, float spacing) {
    SurfelCloud cloud;
    for (int axis = 0; axis < 3; ++axis) {
        add_wall(cloud, axis, low[axis], 1.0f, low, high, spacing);
        add_wall(cloud, axis, high[axis], -1.0f, low, high, spacing);
    }
    return cloud;
}

/// A passage of 1 x 1 m that runs 4 m along X, then 4 m along Y: from (0, 0, 0) round the corner at
/// (4, 0, 0) to (4, 4, 1). From the far end of one leg the far end of the other is out of sight.
inline SurfelCloud dogleg(float spacing) {
    SurfelCloud cloud;
    const auto wall = [&](int axis, float place, float sign, Vec3f low, Vec3f high) {
        add_wall(cloud, axis, place, sign, low, high, spacing);
    };
    for (const float z : {0.0f, 1.0f}) {
        const float sign = z == 0.0f ? 1.0f : -1.0f;
        wall(2, z, sign, {0, 0, 0}, {4, 1, 1});
        wall(2, z, sign, {3, 1, 0}, {4, 4, 1});
    }
    wall(1, 0.0f, 1.0f, {0, 0, 0}, {4, 1, 1});
    wall(1, 1.0f, -1.0f, {0, 0, 0}, {3, 1, 1});
    wall(1, 4.0f, -1.0f, {3, 0, 0}, {4, 4, 1});
    wall(0, 0.0f, 1.0f, {0, 0, 0}, {4, 1, 1});
    wall(0, 4.0f, -1.0f, {0, 0, 0}, {4, 4, 1});
    wall(0, 3.0f, 1.0f, {0, 1, 0}, {4, 4, 1});
    return cloud;
}

/// One lamp there, of 10 W·sr⁻¹ a channel.
inline Scene lamp_at(const Vec3d& position) {
    Scene scene;
    scene.point_lights.push_back({"lamp", position, {10.0f, 10.0f, 10.0f}});
    return scene;
}

}  // namespace glowworm::testing

#pragma once

#include "octree/scene.h"

namespace glowworm::testing {

/// A camera of `width` x `height` pixels; places in m, world, upright.
inline Camera camera_at(Vec3d position, Vec3d look_at, double vfov_deg, int width, int height) {
    Camera camera;
    camera.position = position;
    camera.look_at = look_at;
    camera.vfov_deg = vfov_deg;
    camera.width = width;
    camera.height = height;
    return camera;
}

}  // namespace glowworm::testing

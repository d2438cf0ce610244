#pragma once

#include "octree/vec3.h"

namespace glowworm {

/// A turn from camera axes (x right, y up, z backward) to the world's; unit where it is a rotation.
struct Quaternion {
    double x = 0.0, y = 0.0, z = 0.0, w = 1.0;

    friend Quaternion operator+(const Quaternion& a, const Quaternion& b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w};
    }
    friend Quaternion operator-(const Quaternion& a, const Quaternion& b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w};
    }
    friend Quaternion operator*(const Quaternion& a, double s) {
        return {a.x * s, a.y * s, a.z * s, a.w * s};
    }
};

double dot(const Quaternion& a, const Quaternion& b);

/// Unit; no turn where `q` is zero or not finite.
Quaternion normalized(const Quaternion& q);

/// A camera's up and the direction it looks in, both unit. `q` is unit.
Vec3d up_of(const Quaternion& q);
Vec3d forward_of(const Quaternion& q);

/// The turn of a camera that looks along `forward` with `up` upright; `up` need not be square to
/// it. Where both run along one line, another axis serves as up.
Quaternion looking_along(const Vec3d& forward, const Vec3d& up);

}  // namespace glowworm

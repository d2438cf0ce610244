#include "viewer/app/quaternion.h"

#include <cmath>

namespace glowworm {

double dot(const Quaternion& a, const Quaternion& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

Quaternion normalized(const Quaternion& q) {
    const double norm = std::sqrt(dot(q, q));
    return norm > 0 && std::isfinite(norm) ? q * (1.0 / norm) : Quaternion{};
}

Vec3d up_of(const Quaternion& q) {
    return {2 * (q.x * q.y - q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z),
            2 * (q.y * q.z + q.w * q.x)};
}

Vec3d forward_of(const Quaternion& q) {
    return -Vec3d{2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x),
                  1 - 2 * (q.x * q.x + q.y * q.y)};
}

Quaternion looking_along(const Vec3d& forward, const Vec3d& up) {
    const Vec3d back = -normalized(forward, Vec3d{0, 1, 0});
    Vec3d side = cross(normalized(up), back);
    if (length(side) < 1e-6) {
        side = cross(std::abs(back.z) > 0.5 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1}, back);
    }
    const Vec3d right = normalized(side), above = cross(back, right);
    // The matrix whose columns are right, above and back, by Shepperd's method (1978): the largest
    // of the four components is found first, so that nothing small is divided by.
    const double trace = right.x + above.y + back.z;
    Quaternion q;
    if (trace >= right.x && trace >= above.y && trace >= back.z) {
        q = {above.z - back.y, back.x - right.z, right.y - above.x, 1 + trace};
    } else if (right.x >= above.y && right.x >= back.z) {
        q = {1 + 2 * right.x - trace, above.x + right.y, back.x + right.z, above.z - back.y};
    } else if (above.y >= back.z) {
        q = {above.x + right.y, 1 + 2 * above.y - trace, back.y + above.z, back.x - right.z};
    } else {
        q = {back.x + right.z, back.y + above.z, 1 + 2 * back.z - trace, right.y - above.x};
    }
    return normalized(q);
}

}  // namespace glowworm

#include "viewer/app/walk.h"

#include <algorithm>
#include <cmath>

#include "octree/trace.h"

namespace glowworm {
namespace {

constexpr double kHeadroom = 0.15;   // m between eyes and ceiling
constexpr double kCrawlShare = 0.7;  // of what is left where even that is too much
constexpr double kClimbRate = 9.0;   // 1/s
constexpr double kOpen = 1e6;        // m: no ceiling

/// m from `position` to the surface straight up or down; nothing where there is none.
std::optional<double> surface_along(const OctreeView& octree, const Vec3d& position, float z) {
    const Ray ray{vec3_cast<float>(position - octree.grid.origin), {0.0f, 0.0f, z}};
    const TraceHit hit = trace_ray(octree, TraceSettings{}, ray);
    if (hit.lobe == kNoHit || hit.lobe == kBuried) return std::nullopt;
    return hit.t;
}

}  // namespace

double eye_height(double clearance) {
    return std::clamp(clearance - kHeadroom, std::min(kCrawlShare * clearance, kHeadHeight),
                      kHeadHeight);
}

double stepped_height(double z, double wanted, double seconds) {
    return wanted + (z - wanted) * std::exp(-kClimbRate * seconds);
}

std::optional<double> walking_height(const OctreeView& octree, const Vec3d& position) {
    const auto down = surface_along(octree, position, -1.0f);
    if (!down) return std::nullopt;
    const double up = surface_along(octree, position, 1.0f).value_or(kOpen);
    return position.z - *down + eye_height(*down + up);
}

}  // namespace glowworm

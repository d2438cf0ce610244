#include "viewer/app/pick.h"

#include <cmath>

namespace glowworm {
namespace {

constexpr double kMostEdgeOn = 0.1;  // cosine: flatter planes run away from their pixel

}  // namespace

std::optional<SurfacePoint> surface_point(const View& view, const gpu::vec4& surface, double x,
                                          double y) {
    if (!(surface.w > 0.0f)) return std::nullopt;
    const ViewRay middle = ray_through(view, std::floor(x) + 0.5, std::floor(y) + 0.5);
    const Vec3d there = middle.origin + middle.direction * double{surface.w};
    const Vec3d normal = normalized(Vec3d{surface.x, surface.y, surface.z});
    const ViewRay ray = ray_through(view, x, y);
    const double steepness = dot(ray.direction, normal);
    double depth = surface.w;
    if (std::abs(steepness) > kMostEdgeOn * length(ray.direction)) {
        depth = dot(there - ray.origin, normal) / steepness;
    }
    return SurfacePoint{ray.origin + ray.direction * depth, normal};
}

}  // namespace glowworm

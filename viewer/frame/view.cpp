#include "viewer/frame/view.h"

#include <cmath>
#include <numbers>

namespace glowworm {

View view_of(const Camera& camera) {
    View view;
    view.position = camera.position;
    view.forward = normalized(camera.look_at - camera.position, Vec3d{0, 1, 0});
    Vec3d side = cross(view.forward, normalized(camera.up));
    if (length(side) < 1e-6) {
        side =
            cross(view.forward, std::abs(view.forward.z) > 0.5 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
    }
    view.right = normalized(side);
    view.down = cross(view.forward, view.right);
    view.width = camera.width;
    view.height = camera.height;
    view.centre_x = camera.width / 2.0;
    view.centre_y = camera.height / 2.0;
    view.focal = camera.height / 2.0 / std::tan(camera.vfov_deg * std::numbers::pi / 360.0);
    return view;
}

View tile_of(const View& view, int x, int y, int width, int height) {
    View tile = view;
    tile.centre_x -= x;
    tile.centre_y -= y;
    tile.width = width;
    tile.height = height;
    return tile;
}

View supersampled(const View& view, int n) {
    View fine = view;
    fine.focal *= n;
    fine.centre_x *= n;
    fine.centre_y *= n;
    fine.width *= n;
    fine.height *= n;
    return fine;
}

PixelPoint project(const View& view, const Vec3d& world) {
    const Vec3d offset = world - view.position;
    const double depth = dot(offset, view.forward);
    const double scale = view.orthographic ? view.focal : view.focal / depth;
    return {view.centre_x + dot(offset, view.right) * scale,
            view.centre_y + dot(offset, view.down) * scale, depth};
}

ViewRay ray_through(const View& view, double x, double y) {
    const Vec3d sideways = view.right * ((x - view.centre_x) / view.focal) +
                           view.down * ((y - view.centre_y) / view.focal);
    if (view.orthographic) return {view.position + sideways, view.forward};
    return {view.position, view.forward + sideways};
}

}  // namespace glowworm

#include "shadow_maps.h"

#include <algorithm>
#include <cmath>

namespace glowworm {
namespace {

const CubeMap::Face& face_towards(const CubeMap& map, const Vec3d& way) {
    int axis = 0;
    for (int a = 1; a < 3; ++a) {
        if (std::abs(way[a]) > std::abs(way[axis])) axis = a;
    }
    return map.faces[static_cast<std::size_t>(2 * axis + (way[axis] > 0 ? 1 : 0))];
}

/// Whether what is `distance` m off the lamp lies before what the texel that way shows.
bool is_lit(const CubeMap& map, const Vec3d& way, double distance) {
    const CubeMap::Face& face = face_towards(map, way);
    const PixelPoint at = project(face.view, map.lamp + way);
    const int x = std::clamp(static_cast<int>(at.x), 0, map.size - 1);
    const int y = std::clamp(static_cast<int>(at.y), 0, map.size - 1);
    const auto depth = static_cast<double>(face.depths[static_cast<std::size_t>(y * map.size + x)]);
    return depth <= 0 ||
           distance < depth * length(ray_through(face.view, x + 0.5, y + 0.5).direction);
}

}  // namespace

double CubeMap::visibility(const Vec3d& position, const Vec3d& normal, double texels,
                           double offset) const {
    const Vec3d way = position - lamp;
    const double texel = 2.0 * dot(way, face_towards(*this, way).view.forward) / size;
    const Vec3d moved = position + normal * (offset + texels * texel);
    const Face& face = face_towards(*this, moved - lamp);
    const PixelPoint at = project(face.view, moved);
    int lit = 0;
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
            const ViewRay ray =
                ray_through(face.view, std::floor(at.x) + x + 0.5, std::floor(at.y) + y + 0.5);
            lit += is_lit(*this, ray.direction, length(moved - lamp)) ? 1 : 0;
        }
    }
    return lit / 9.0;
}

CubeMap draw_cube(Frame& frame, const Vec3d& lamp, int size) {
    CubeMap map{.faces = {}, .lamp = lamp, .size = size};
    for (int i = 0; i < 6; ++i) {
        Vec3d way{0, 0, 0};
        way[i / 2] = i % 2 == 0 ? -1 : 1;
        CubeMap::Face& face = map.faces[static_cast<std::size_t>(i)];
        face.view = view_of({"", lamp, lamp + way, {0, 0, 1}, 90.0, size, size, ""});
        frame.draw_surfaces(face.view, Frame::Missing::kWaitFor);
        const auto surfaces =
            frame.gbuffer().surfaces().read<gpu::vec4>(static_cast<std::size_t>(size * size));
        for (const gpu::vec4& surface : surfaces)
            face.depths.push_back(surface.w);
    }
    return map;
}

}  // namespace glowworm

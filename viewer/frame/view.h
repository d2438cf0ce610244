#pragma once

#include <optional>

#include "octree/scene.h"
#include "octree/vec3.h"

namespace glowworm {

/// An axis-aligned box, m, world.
struct WorldBox {
    Vec3d low, high;
    bool operator==(const WorldBox&) const = default;
};

/// What a picture is taken through: a pinhole or an orthographic camera over a rectangle of pixels.
/// Camera space counts pixels to the right and down and depth forward; depth is the distance along
/// the view axis in m, not along the ray.
struct View {
    Vec3d position;          ///< m, world
    Vec3d right{1, 0, 0};    ///< unit, world; toward larger x
    Vec3d down{0, 0, -1};    ///< unit, world; toward larger y
    Vec3d forward{0, 1, 0};  ///< unit, world
    double focal = 1.0;      ///< pixels per unit of x/depth; orthographic: pixels per m
    bool orthographic = false;
    double centre_x = 0.0;  ///< pixels: where the view axis meets the picture
    double centre_y = 0.0;
    int width = 0, height = 0;  ///< pixels
    std::optional<WorldBox>
        clip;  ///< only what lies within is drawn; light comes from all the cave
};

struct PixelPoint {
    double x, y;   ///< pixels; a pixel's centre is at +0.5
    double depth;  ///< m along the view axis; not positive behind a pinhole
};

/// The rays of a pinhole leave its position; orthographic ones leave the plane through it.
struct ViewRay {
    Vec3d origin;     ///< m, world
    Vec3d direction;  ///< world; one unit of it is 1 m of depth
};

/// The view of a scene's camera. Where `up` runs along the line of sight, another axis serves.
View view_of(const Camera& camera);

/// `width` x `height` pixels of `view` from (x, y) on: the same rays, so tiles join without a seam.
View tile_of(const View& view, int x, int y, int width, int height);

/// Each pixel of `view` divided into n x n.
View supersampled(const View& view, int n);

PixelPoint project(const View& view, const Vec3d& world);

/// The ray through a point of the picture, in pixels.
ViewRay ray_through(const View& view, double x, double y);

}  // namespace glowworm

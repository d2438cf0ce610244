#pragma once

#include <optional>

#include "shaders/gpu_layout.h"
#include "viewer/frame/view.h"

namespace glowworm {

/// A point on the cave's surface that a cursor is on.
struct SurfacePoint {
    Vec3d position;  ///< m, world
    Vec3d normal;    ///< unit, world
};

/// What the cursor at (x, y), in `view`'s pixels, is on: the pixel's surface (normal; w: depth in
/// m, 0 for none) is a piece of plane through the pixel's middle, and the cursor's own ray meets
/// it. Seen so edge-on that the plane says nothing, the pixel's depth counts.
std::optional<SurfacePoint> surface_point(const View& view, const gpu::vec4& surface, double x,
                                          double y);

}  // namespace glowworm

#pragma once

#include <array>
#include <vector>

#include "viewer/frame/frame.h"

namespace glowworm {

/// Depths of the surfels round a lamp, the usual way to its shadows: to compare ours with.
struct CubeMap {
    struct Face {
        View view;
        std::vector<float> depths;  ///< [size * size] m along the view axis; 0: nothing
    };
    std::array<Face, 6> faces;  ///< -x, +x, -y, +y, -z, +z
    Vec3d lamp;                 ///< m, world
    int size = 0;               ///< texels along a face's edge

    /// The share of 3 x 3 texels, 0..1, that see a point of a surface (m, world), as it lies moved
    /// along its unit normal by so many texels and `offset` m.
    double visibility(const Vec3d& position, const Vec3d& normal, double texels,
                      double offset) const;
};

/// Waits for the surfels it needs.
CubeMap draw_cube(Frame& frame, const Vec3d& lamp, int size);

}  // namespace glowworm

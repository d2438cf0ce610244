#pragma once

#include "octree/surfel.h"
#include "preprocess/plot/picture.h"

namespace glowworm {

/// Pixels around the plans of plot_surfels.
inline constexpr int kPlanMargin = 24;

/// Two plans side by side, Y up, `size` pixels along the longer side of each (64..8192), each in
/// its half of the picture with kPlanMargin around it, and a legend under them. Left: normals as
/// colours, (n + 1) / 2; right: NDF length from dark violet (0.8 and less: rough) to yellow (1:
/// flat). Of surfels over each other the highest that faces up is seen, else the lowest: floors and
/// walls, not the roof over them. Empty in, empty out.
Picture plot_surfels(const SurfelCloud& cloud, int size = 1024);

}  // namespace glowworm

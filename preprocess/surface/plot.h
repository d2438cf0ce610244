#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "octree/surfel.h"

namespace glowworm {

/// An 8-bit RGB picture, row 0 at the top, three bytes a pixel.
struct PlanView {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
};

/// Two plans side by side, north up, `size` pixels along the longer side of each (64..8192). Left:
/// normals as colours, (n + 1) / 2; right: NDF length from dark violet (0.8 and less: rough) to
/// yellow (1: flat). Of surfels over each other the highest that faces up is seen, else the lowest:
/// floors and walls, not the roof over them. Empty in, empty out.
PlanView plot_surfels(const SurfelCloud& cloud, int size = 1024);

/// Writes a PNG, whole or not at all. Throws Error as AtomicFile does, kDegenerate for an empty
/// picture.
void write_png(const PlanView& picture, const std::filesystem::path& path);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "shaders/gpu_layout.h"

namespace glowworm {

/// Twins of the passes that follow links, for where OpenGL runs on the CPU: there a pass reads a
/// link ten times slower than compiled code does. All on all cores, the same on any number of them.

/// Rows of links, one for each lobe, `stride` apart; of each the first `rays` count.
struct LinkRows {
    std::span<const std::uint32_t> links;
    std::uint32_t stride = 0, rays = 0;

    std::span<const std::uint32_t> of(std::size_t lobe) const {
        return links.subspan(lobe * stride, rays);
    }
};

/// Of a row's rays, those that are not buried; at least 1.
float open_rays(std::span<const std::uint32_t> row);

/// gathered: [rows] pi times the mean radiance over each row's links (bounce.comp). `radiance`:
/// [lobes].
void bounce_along(const LinkRows& rows, std::span<const gpu::vec4> radiance,
                  std::span<gpu::vec4> gathered);

/// [lobes] irradiance, and how it changes as the surface turns (light_gradient.comp); `walls` are
/// those of walls.h.
std::vector<gpu::LobeLight> light_gradients(const LinkRows& rows, std::span<const Lobe> lobes,
                                            std::span<const gpu::vec4> radiance,
                                            std::span<const gpu::vec4> irradiance,
                                            std::span<const std::uint32_t> walls);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <span>

#include "octree/octree_file.h"
#include "octree/ray_tracer.h"
#include "shaders/gpu_layout.h"

namespace glowworm {

/// Twins of inject.comp and probe_direct.comp for where OpenGL runs on the CPU: the same
/// formulas as compiled code, their shadow rays traced many at once. On all cores, the same on any
/// number of them.

/// What they read.
struct DirectLightInput {
    const RayTracer& tracer;
    std::span<const Lobe> lobes;  ///< with closed patches
    std::span<const gpu::Light> lights;
    const gpu::LightGrid& grid;
};

/// Adds the irradiance straight from light number `light` to lobes from `first` on; `direct` are
/// theirs, W·m⁻².
void add_direct_light(const DirectLightInput& input, std::uint32_t light, std::size_t first,
                      std::span<gpu::vec4> direct);

/// Irradiance straight from all lights at surface points: of `places` each one's position (m,
/// relative to the octree's origin) and normal, of `measured` the first of each two.
void measure_direct_light(const DirectLightInput& input, std::span<const gpu::vec4> places,
                          std::span<gpu::vec4> measured);

}  // namespace glowworm

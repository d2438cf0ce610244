#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "octree/vec3.h"
#include "shaders/gpu_layout.h"

namespace glowworm {

/// The twin of probe_indirect.comp for where OpenGL runs on the CPU, and what light of groups of
/// lobes needs everywhere: the same formulas as compiled code. On all cores, the
/// same on any number of them.

/// What they read: an octree's, or those of a tree of light domains (domains.h).
struct LookupInput {
    std::span<const Node> nodes;
    std::span<const Lobe> lobes;  ///< with closed patches
    std::span<const gpu::LobeLight> lobe_lights;
    const gpu::LightGrid& grid;
};

/// Reflected irradiance at surface points: of `places` each one's position (m, relative to the
/// octree's origin) and normal, of `measured` the second of each two; w is 0 where there is no
/// surface near.
void measure_indirect_light(const LookupInput& input, std::span<const gpu::vec4> places,
                            std::span<gpu::vec4> measured);

/// A surface point, m, relative to the octree's origin, which way it faces, and its lobe.
struct SurfacePlace {
    Vec3f position, normal;
    std::uint32_t lobe = 0;
};

/// [places] reflected light there (tricubic), what lies beyond the wall beside each one's lobe kept
/// apart; where no lobe near faces its way, that of its own, turned.
std::vector<gpu::LobeLight> light_at(const LookupInput& input,
                                     std::span<const SurfacePlace> places);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "octree/scene.h"
#include "octree/trace.h"

namespace glowworm::testing {

/// The light's formulas once more, on the CPU in plain loops and double precision: what the GPU's
/// passes are held against. Positions are relative to the octree's origin.

/// Irradiance straight from the lights, W·m⁻². Shadow rays start `offset` metres off the surface;
/// an area light's rectangle is sampled at `area_samples` points along each edge.
Vec3d direct_irradiance(const OctreeView& octree, const TraceSettings& trace, const Scene& scene,
                        const Vec3f& position, const Vec3f& normal, float offset,
                        int area_samples = 16);

/// [lobes] indirect irradiance after `bounces` products from nothing, W·m⁻².
std::vector<Vec3d> bounce(const OctreeView& octree, std::span<const std::uint32_t> links,
                          std::uint32_t rays, std::span<const Vec3d> direct, int bounces);

/// The field between the lobes.
Vec3d look_up(const OctreeView& octree, std::span<const Vec3d> field, const Vec3f& position,
              const Vec3f& normal, bool tricubic);

}  // namespace glowworm::testing

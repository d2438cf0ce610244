#pragma once

#include <array>
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

/// Reflected light at a lobe, W·m⁻².
struct LocalLight {
    Vec3d irradiance;
    std::array<Vec3d, 3> turn;  ///< per channel, what tilting the normal adds
    Vec3d around;               ///< pi times the radiance of the rock there
    std::uint32_t wall = 0;     ///< walls.h, once smoothed
};

/// [lobes] reflected light after `bounces` products from nothing.
std::vector<LocalLight> bounce(const OctreeView& octree, std::span<const std::uint32_t> links,
                               std::uint32_t rays, std::span<const Vec3d> direct, int bounces);

/// [lobes] the same with the noise of rays spread over two leaves.
std::vector<LocalLight> smooth(const OctreeView& octree, std::span<const LocalLight> lights);

/// Light between the lobes, from `width` times the lookup's reach.
LocalLight look_up(const OctreeView& octree, std::span<const LocalLight> lights,
                   const Vec3f& position, const Vec3f& normal, bool tricubic, double width = 1.0,
                   std::uint32_t wall = 0);

}  // namespace glowworm::testing

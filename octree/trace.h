#pragma once

#include <cstdint>
#include <limits>

#include "octree/octree_file.h"
#include "octree/vec3.h"

namespace glowworm {

/// How a ray meets the surface. Every leaf lobe is a piece of plane through its mean position,
/// bounded by the box of its samples and by the plane of the second lobe in its leaf: a ray meets
/// surfaces where they are, not where voxels are. Octrees traced here have patches that were closed
/// (close_patches.h). shaders/trace.glsl is the same walk on the GPU: same rays, same hits.
struct TraceSettings {
    /// How far a piece of plane reaches past its outermost samples, in sample spacings, 0..1.
    /// Larger narrows passages (silhouettes grow), smaller lets light through between leaves.
    float patch_margin = 0.1f;
    /// How far from its leaf's centre a piece of plane may be hit, per axis in leaf edges, ≥ 0.5.
    float reach = 0.75f;
};

/// A ray in metres relative to the octree's origin.
struct Ray {
    Vec3f origin;
    Vec3f direction;     ///< unit
    Vec3f normal;        ///< unit, of the surface it leaves; else zero
    float t_min = 0.0f;  ///< m: not met nearer is the surface it leaves
    float t_max = std::numeric_limits<float>::max();  ///< m
};

/// What light gathered along a ray comes from.
struct TraceHit {
    std::uint32_t lobe = kNoHit;
    float t = 0.0f;  ///< m
};

/// The lobe whose front the ray meets first. A ray that slips between two pieces of plane and then
/// meets a back side, or leaves the octree, takes the first front it passed by; with none it is
/// kBuried or kNoHit.
TraceHit trace_ray(const OctreeView& octree, const TraceSettings& settings, const Ray& ray);

/// The flat thing a shadow ray ends on: a lamp's own samples and a wall that it is mounted flush
/// with do not shadow it.
struct ShadowTarget {
    Vec3f normal;             ///< unit; zero for a lamp without extent
    std::uint32_t light = 0;  ///< what the lamp's lobes carry, 0: none
};

/// Whether nothing, seen from either side, lies on `ray` between t_min and t_max.
bool is_unoccluded(const OctreeView& octree, const TraceSettings& settings, const Ray& ray,
                   const ShadowTarget& target = {});

/// Where gather and shadow rays leave a lobe: off its plane by what its samples scatter.
Ray ray_from_lobe(const OctreeView& octree, const Lobe& lobe, const Vec3f& direction);

}  // namespace glowworm

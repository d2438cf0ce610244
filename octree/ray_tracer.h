#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "octree/occupancy.h"
#include "octree/octree_file.h"
#include "octree/trace.h"

namespace glowworm {

/// A ray that ends at a lamp.
struct ShadowRay {
    Ray ray;
    ShadowTarget target;
};

/// Traces many rays: what trace.h finds, to the bit, several times as fast. Walks advance side by
/// side in the lanes of vector registers, and a ray that has ended gives its lane to the next one.
/// Rays that follow one another and go similar ways find what they read in caches.
class RayTracer {
  public:
    /// Of an octree whose patches are closed (close_patches.h). Keeps what it needs of it.
    RayTracer(const OctreeView& octree, const TraceSettings& settings);

    /// [rays] the lobe that trace_ray() finds.
    void trace(std::span<const Ray> rays, std::span<std::uint32_t> lobes) const;

    /// [rays] 1 where is_unoccluded() says so, else 0.
    void look(std::span<const ShadowRay> rays, std::span<std::uint8_t> seen) const;

    /// A lobe as rays meet it: what trace.h reckons anew for every ray. A cache line.
    struct alignas(64) Patch {
        Vec3f position;  ///< m
        std::uint32_t lobe = 0;
        Vec3f ndf;
        std::uint32_t light = 0;   ///< Lobe::light
        Vec3f low;                 ///< m from the cell's lower corner, the margin taken off
        std::uint32_t others = 0;  ///< of a leaf's first: its second, the third comes after it
        Vec3f high;
        std::uint16_t count = 1;  ///< of a leaf's first: how many the leaf has
        std::uint16_t wedge = 0;  ///< 1: two are surface, and each ends where they meet
    };

  private:
    template <typename Rule>
    void walk(Rule& rule) const;

    Grid grid_;
    TraceSettings settings_;
    Occupancy occupancy_;
    std::vector<Patch> patches_;  // [leaves] first ones, then the others
};

/// A tracer of an octree as it lies in a file: closes its patches first.
std::shared_ptr<const RayTracer> make_ray_tracer(const OctreeView& octree,
                                                 const TraceSettings& settings);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "octree/ray_tracer.h"
#include "octree/scene.h"
#include "shaders/gpu_layout.h"
#include "viewer/gpu/context.h"
#include "viewer/gpu/objects.h"
#include "viewer/light/settings.h"

namespace glowworm {

/// The octree's part that light needs, in GPU memory nearly as it lies in the file.
struct GpuOctree {
    Buffer nodes;  ///< Node
    Buffer lobes;  ///< Lobe
    gpu::LightGrid grid{};
};

/// Bytes on the GPU while the light of an octree of so many nodes and lobes settles: the octree,
/// its links or cones, the light of its lobes, and what settling and smoothing keep meanwhile.
std::uint64_t light_bytes(std::uint64_t nodes, std::uint64_t lobes, const LightSettings& settings);

/// The same where reflected light is that of so many groups of lobes (group_light.h).
std::uint64_t grouped_light_bytes(std::uint64_t nodes, std::uint64_t lobes, std::uint64_t groups,
                                  const LightSettings& settings);

/// Whether what has a twin in compiled code is done by that: where OpenGL runs on the CPU.
bool runs_compiled(const Context& context, const LightSettings& settings);

/// Whether shaders of `context` can see all of the octree and the light of its lobes.
bool fits_shaders(const Context& context, const OctreeView& octree);

/// What light needs of an octree and what takes a while to work out of a large one, without OpenGL.
struct LightGround {
    std::vector<Lobe> closed;                 ///< close_patches.h
    std::shared_ptr<const RayTracer> tracer;  ///< of them; null where only the GPU traces
};
LightGround make_light_ground(const OctreeView& octree, const TraceSettings& settings,
                              bool with_tracer);

/// `closed` are the octree's lobes with closed patches. Throws Error (kBudget) where shaders would
/// read it and a section is larger than one binding of `context` may show.
GpuOctree upload(const Context& context, const OctreeView& octree, std::span<const Lobe> closed,
                 const LightSettings& settings);

/// The scene's lights relative to the octree's origin. An area light's tag is that of the octree's
/// area light with its name, else of one at the same place. Left out under `faithful`, where area
/// lights are nothing but emitting lobes.
std::vector<gpu::Light> lights_for_gpu(const Scene& scene, const OctreeView& octree, bool faithful);

/// [lobes] radiance that each lobe sends into the gather, W·sr⁻¹·m⁻²: what emits and is not one of
/// the scene's area lights, which are sampled instead; under `faithful` those as well, as bright as
/// the scene says.
std::vector<gpu::vec4> emitted_radiance(const Scene& scene, const OctreeView& octree,
                                        bool faithful);

}  // namespace glowworm

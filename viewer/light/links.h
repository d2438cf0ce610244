#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "octree/octree_file.h"
#include "octree/progress.h"
#include "octree/ray_tracer.h"
#include "shaders/gpu_layout.h"
#include "viewer/gpu/context.h"
#include "viewer/gpu/objects.h"
#include "viewer/gpu/program.h"
#include "viewer/light/bounce.h"
#include "viewer/light/settings.h"

namespace glowworm {

/// Which lobe each gather ray meets (octree/links.h). Where OpenGL runs on the CPU they stay in the
/// process' memory, baked ones in the mapped file; else they are in GPU memory, rows of `rays`
/// links in blocks of lobes, each small enough to be bound.
class GpuLinks {
  public:
    GpuLinks() = default;
    /// Takes the octree's baked links where they have at least as many rays, else traces them: on
    /// all CPU cores where OpenGL runs on the CPU, else on the GPU, whose octree is bound, there
    /// `first_rays` for now. The octree must outlive it; `tracer` is its own, where there is one.
    GpuLinks(const Context& context, const OctreeView& octree, const LightSettings& settings,
             const Progress& progress, std::uint32_t first_rays = kMostLinks,
             std::shared_ptr<const RayTracer> tracer = nullptr);
    /// Links in the process' memory that something else has traced and keeps.
    explicit GpuLinks(const LinkRows& rows);
    /// Traces as many rays again as there are, on the GPU, whose octree is bound. False where there
    /// are all that the settings ask for.
    bool trace_more(const Progress& progress = {});

    bool empty() const { return blocks_.empty() && rows_.links.empty(); }
    std::uint32_t rays() const { return rows_.rays; }  ///< of a lobe, so far
    std::uint32_t all_rays() const { return all_rays_; }
    /// Links in the process' memory; nothing where the GPU has them.
    const LinkRows* on_cpu() const { return rows_.links.empty() ? nullptr : &rows_; }

    /// gathered = pi times the mean radiance over each lobe's links, by lobes. `radiance` is bound
    /// at BINDING_RADIANCE, `gathered` at BINDING_SCRATCH_B.
    void gather(const Buffer& radiance, Buffer& gathered) const;
    /// Runs `pass` over the GPU's blocks with each one's links bound; uniforms 0, 1 and 2 are its
    /// first lobe, its last and the rays.
    void over_blocks(const Program& pass) const;

    /// [lobes x rays()], for comparison with the CPU's.
    std::vector<std::uint32_t> read() const;

  private:
    struct Block {
        std::uint32_t first_lobe, last_lobe;
        Buffer links;
    };
    void make_blocks(const Context& context);
    void upload();
    struct Rays {
        std::uint32_t first, last;
    };
    void trace(Rays rays, const Progress& progress);

    std::uint32_t lobes_ = 0;
    std::uint32_t all_rays_ = 0;  // of a lobe, once they are traced
    LinkRows rows_;
    std::vector<std::uint32_t> traced_;
    std::vector<Block> blocks_;
    Program bounce_;
};

}  // namespace glowworm

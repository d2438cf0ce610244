#pragma once

#include <cstdint>
#include <vector>

#include "octree/octree_file.h"
#include "octree/progress.h"
#include "shaders/gpu_layout.h"
#include "viewer/gpu/context.h"
#include "viewer/gpu/objects.h"
#include "viewer/gpu/program.h"
#include "viewer/light/settings.h"

namespace glowworm {

/// Which lobe each gather ray meets (octree/links.h), in GPU memory: rows of `rays` links in blocks
/// of lobes, each small enough to be bound.
class GpuLinks {
  public:
    GpuLinks() = default;
    /// Takes the octree's baked links where they have at least as many rays, else traces them: on
    /// all CPU cores where OpenGL runs on the CPU, else on the GPU, whose octree is bound.
    GpuLinks(const Context& context, const OctreeView& octree, const LightSettings& settings,
             const Progress& progress);

    bool empty() const { return blocks_.empty(); }
    std::uint32_t rays() const { return rays_; }

    /// gathered = pi times the mean radiance over each lobe's links. Radiance is bound at
    /// BINDING_RADIANCE, what is gathered at BINDING_SCRATCH_B.
    void gather() const;
    /// Runs `pass` over the blocks with each one's links bound; uniforms 0, 1 and 2 are its first
    /// lobe, its last and the rays.
    void over_blocks(const Program& pass) const;

    /// [lobes x rays], for comparison with the CPU's.
    std::vector<std::uint32_t> read() const;

  private:
    struct Block {
        std::uint32_t first_lobe, last_lobe;
        Buffer links;
    };
    void trace(const Progress& progress);

    std::uint32_t rays_ = 0;
    std::uint32_t lobes_ = 0;
    std::vector<Block> blocks_;
    Program bounce_;
};

}  // namespace glowworm

#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "shaders/frame_layout.h"
#include "viewer/frame/occlusion.h"
#include "viewer/frame/splat_input.h"

namespace glowworm {

/// Twin of splat_depth.comp, splat_blend.comp, the rims' passes and surface_resolve.comp for where
/// OpenGL runs on the CPU: the same formulas as compiled code, on all cores. Discs are sorted into
/// squares of pixels, each of which one thread draws, so that nothing needs to be atomic; the same
/// on any number of threads. The nearest chunks' come first, and of the others' only discs that
/// these do not hide.
class SplatPass {
  public:
    SplatPass();
    ~SplatPass();

    void begin(const gpu::ViewBlock& view);
    /// Adds the draws from `first_draw` on, as far as depth goes.
    void add(const SplatInput& input, std::size_t first_draw);
    /// How far one sees so far.
    const DepthPyramid& pyramid();
    /// Averages what lies within a radius behind the nearest disc. Fills [pixels] each.
    void blend(std::span<gpu::vec4> surfaces, std::span<gpu::vec4> albedos);
    /// Lets through what lies behind rims, and closes gaps.
    void open_rims(std::span<gpu::vec4> surfaces, std::span<gpu::vec4> albedos);

  private:
    struct Picture;
    std::unique_ptr<Picture> picture_;
};

}  // namespace glowworm

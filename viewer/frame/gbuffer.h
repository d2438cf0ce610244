#pragma once

#include <span>

#include "octree/octree_file.h"
#include "viewer/frame/selection.h"
#include "viewer/frame/surfel_pages.h"
#include "viewer/frame/view.h"
#include "viewer/gpu/program.h"

namespace glowworm {

/// The visible surface at every pixel, from discs rasterised by compute: 32-bit atomics find the
/// nearest disc, then all discs within a radius of it are averaged.
class GBuffer {
  public:
    GBuffer();

    /// Draws `selection` as seen by `view`; the buffers grow to its size.
    void draw(const OctreeView& octree, const SurfelPages& cloud,
              std::span<const ChunkSelection> selection, const View& view);

    /// Unit normal in the world; w: depth in m, 0 where nothing was hit. Row 0 is the top one.
    const Texture& surface() const { return surface_; }
    /// Linear albedo; w: NDF length.
    const Texture& albedo() const { return albedo_; }
    /// The camera of the last `draw`, ViewBlock of shaders/frame_layout.h.
    const Buffer& view_block() const { return view_block_; }

  private:
    void resize(int width, int height);

    Program depth_{{"splat_depth.comp"}}, blend_{{"splat_blend.comp"}};
    Program resolve_{{"surface_resolve.comp"}};
    Buffer view_block_, chunks_, batches_;
    Buffer depths_, normal_sums_, albedo_sums_, behind_sums_;
    Texture surface_, albedo_;
};

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "shaders/frame_layout.h"
#include "viewer/frame/occlusion.h"
#include "viewer/frame/selection.h"
#include "viewer/frame/splat_pass.h"
#include "viewer/frame/splat_shaders.h"
#include "viewer/frame/surfel_cache.h"
#include "viewer/frame/timed_pass.h"
#include "viewer/frame/view.h"

namespace glowworm {

/// The visible surface at every pixel: the nearest disc, averaged with all discs within a radius of
/// it. Discs reach past the edges of the surface they stand for; where they hardly add up, what
/// lies behind shows instead. The same cloud and view give the same bits, in whatever order its
/// parts come. By shaders; where OpenGL runs on the CPU by compiled code. Pixels lie row by row,
/// the top one first.
class GBuffer {
  public:
    GBuffer();

    /// Begins a frame: nothing is in it yet.
    void begin(const OctreeView& octree, const View& view);
    /// Adds `selection`, all of which is on the GPU, to it as far as depth goes.
    void add(const OctreeView& octree, const SurfelCache& cloud,
             std::span<const ChunkSelection> selection, PassTimer* timer = nullptr);
    /// How far one sees so far. Waits for the GPU.
    DepthPyramid pyramid(PassTimer* timer = nullptr);
    /// Makes surfaces of all that was added; `cloud` as it was then.
    void finish(const SurfelCache& cloud, PassTimer* timer = nullptr);

    /// Binds the view and the pixels for passes that go on from here.
    void bind() const;

    /// [pixels] vec4: unit normal in the world; w: depth in m, 0 where nothing was hit.
    const Buffer& surfaces() const { return surfaces_; }
    /// [pixels] vec4: linear albedo; w: NDF length.
    const Buffer& albedos() const { return albedos_; }
    /// The view as passes see it.
    const gpu::ViewBlock& view_block() const { return view_block_; }

    /// Frame::force_shaders
    void force_shaders(bool force) { shaders_forced_ = force; }

  private:
    SplatInput input(const SurfelCache& cloud) const;

    std::optional<SplatShaders> shaders_;  // one of the two, made when first asked for
    std::optional<SplatPass> pass_;
    bool shaders_forced_ = false, by_shaders_ = true;
    View shown_;
    gpu::ViewBlock view_block_{};
    std::vector<gpu::DrawnChunk> chunks_;
    std::vector<gpu::SplatBatch> batches_;
    std::vector<PageDraw> draws_;
    Buffer view_, surfaces_, albedos_;
};

}  // namespace glowworm

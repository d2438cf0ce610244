#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "shaders/frame_layout.h"
#include "viewer/frame/occlusion.h"
#include "viewer/frame/selection.h"
#include "viewer/frame/surfel_cache.h"
#include "viewer/frame/timed_pass.h"
#include "viewer/frame/view.h"
#include "viewer/gpu/program.h"

namespace glowworm {

/// The visible surface at every pixel, from discs rasterised by compute: 32-bit atomics find the
/// nearest disc, then all discs within a radius of it are averaged. Discs reach past the edges of
/// the surface they stand for; where they hardly add up, what lies behind shows instead. Sums are
/// integers, so the same cloud and view give the same bits, in whatever order its parts come.
/// Pixels lie row by row, the top one first.
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

  private:
    /// What one page draws: a range of the batches.
    struct PageDraw {
        std::size_t page;
        std::uint32_t first_batch, batch_count;
    };

    void resize(std::size_t pixels);
    void bind_splats() const;
    void splat(const Program& pass, const SurfelCache& cloud, std::size_t first_draw) const;

    Program depth_{{"splat_depth.comp"}}, blend_{{"splat_blend.comp"}};
    Program depth_behind_{{"splat_depth.comp"}, {"BEHIND_RIMS"}};
    Program blend_behind_{{"splat_blend.comp"}, {"BEHIND_RIMS"}};
    Program depth_tiles_{{"depth_tiles.comp"}};
    Program find_rims_{{"rim_find.comp"}}, open_rims_{{"rim_open.comp"}};
    Program resolve_{{"surface_resolve.comp"}};
    View shown_;
    gpu::ViewBlock view_block_{};
    std::vector<gpu::DrawnChunk> chunks_;
    std::vector<gpu::SplatBatch> batches_;
    std::vector<PageDraw> draws_;
    Buffer view_, chunk_buffer_, batch_buffer_, tiles_;
    Buffer depths_, rims_, rim_tiles_, normal_sums_, albedo_sums_, behind_sums_;
    Buffer surfaces_, albedos_;
    std::size_t pixels_ = 0;
};

}  // namespace glowworm

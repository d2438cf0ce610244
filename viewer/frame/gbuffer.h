#pragma once

#include <span>

#include "octree/octree_file.h"
#include "viewer/frame/selection.h"
#include "viewer/frame/surfel_pages.h"
#include "viewer/frame/timed_pass.h"
#include "viewer/frame/view.h"
#include "viewer/gpu/program.h"

namespace glowworm {

/// The visible surface at every pixel, from discs rasterised by compute: 32-bit atomics find the
/// nearest disc, then all discs within a radius of it are averaged. Discs reach past the edges of
/// the surface they stand for; where they hardly add up, what lies behind shows instead. Sums are
/// integers, so the same cloud and view give the same bits. Pixels lie row by row, the top one
/// first.
class GBuffer {
  public:
    GBuffer();

    /// Draws `selection` as seen by `view`; `timer`, where given, takes each pass's time.
    void draw(const OctreeView& octree, const SurfelPages& cloud,
              std::span<const ChunkSelection> selection, const View& view,
              PassTimer* timer = nullptr);

    /// Binds the view and the pixels for passes that go on from here.
    void bind() const;

    /// [pixels] vec4: unit normal in the world; w: depth in m, 0 where nothing was hit.
    const Buffer& surfaces() const { return surfaces_; }
    /// [pixels] vec4: linear albedo; w: NDF length.
    const Buffer& albedos() const { return albedos_; }

  private:
    void resize(std::size_t pixels);

    Program depth_{{"splat_depth.comp"}}, blend_{{"splat_blend.comp"}};
    Program depth_behind_{{"splat_depth.comp"}, {"BEHIND_RIMS"}};
    Program blend_behind_{{"splat_blend.comp"}, {"BEHIND_RIMS"}};
    Program find_rims_{{"rim_find.comp"}}, open_rims_{{"rim_open.comp"}};
    Program resolve_{{"surface_resolve.comp"}};
    Buffer view_, chunks_, batches_;
    Buffer depths_, rims_, rim_tiles_, normal_sums_, albedo_sums_, behind_sums_;
    Buffer surfaces_, albedos_;
    std::size_t pixels_ = 0;
};

}  // namespace glowworm

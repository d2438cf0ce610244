#pragma once

#include "octree/octree_file.h"
#include "viewer/frame/gbuffer.h"
#include "viewer/gpu/objects.h"
#include "viewer/gpu/program.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// All points of a cloud as sphere sprites, depth and three targets written: the G-buffer of the
/// 2016 paper (3.3), to be measured beside ours. The cloud must fit into one storage binding.
class Sprites {
  public:
    Sprites(const OctreeView& octree, int width, int height);

    /// Draws what the view that `gbuffer` was last begun with sees; `scale`: drawn radius over
    /// stored radius.
    void draw(const OctreeView& octree, const GBuffer& gbuffer, float scale);
    /// Deferred shading of what was drawn, [pixels] radiance, w: 1 where a sphere was hit:
    /// reflected light from the leaves round each pixel, one shadow ray for each lamp. By compiled
    /// code where OpenGL runs on the CPU, as ours is.
    std::vector<gpu::vec4> shade(const View& view, const LightField& light) const;

  private:
    Program program_{{"sprite.vert", "sprite.frag"}};
    VertexArray vertices_{"sprites"};
    Buffer surfels_;
    Texture normals_, albedos_, depths_, depth_buffer_;
    Framebuffer framebuffer_;
};

}  // namespace glowworm

#include "bench/frame_sprites.h"

#include <array>

#include "shaders/frame_layout.h"

namespace glowworm {

Sprites::Sprites(const OctreeView& octree, int width, int height)
    : surfels_(Buffer::of("all surfels", octree.surfels)),
      normals_("sprite normals", GL_RGBA16F, width, height),
      albedos_("sprite albedos", GL_RGBA16F, width, height),
      depths_("sprite depths", GL_R32F, width, height),
      depth_buffer_("sprite depth buffer", GL_DEPTH_COMPONENT32F, width, height) {
    const std::array<const Texture*, 3> colours = {&normals_, &albedos_, &depths_};
    framebuffer_ = Framebuffer("sprites", colours, &depth_buffer_);
}

void Sprites::draw(const OctreeView& octree, const GBuffer& gbuffer, float scale) {
    framebuffer_.bind();
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gbuffer.bind();
    surfels_.bind_storage(BINDING_SURFELS);
    vertices_.bind();
    program_.use();
    set_uniform(program_, 1, scale);
    for (const Chunk& chunk : octree.chunks) {
        glProgramUniform4f(program_.name(), 0, chunk.box_min[0], chunk.box_min[1], chunk.box_min[2],
                           chunk.box_edge);
        glDrawArrays(GL_POINTS, static_cast<GLint>(chunk.first), static_cast<GLsizei>(chunk.count));
    }
    glDisable(GL_DEPTH_TEST);
}

}  // namespace glowworm

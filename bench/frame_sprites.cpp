#include "bench/frame_sprites.h"

#include <array>
#include <numbers>

#include "shaders/frame_layout.h"
#include "viewer/light/light_meter.h"

namespace glowworm {

Sprites::Sprites(const OctreeView& octree, int width, int height)
    : surfels_(Buffer::of("all surfels", octree.surfels)),
      normals_("sprite normals", GL_RGBA32F, width, height),
      albedos_("sprite albedos", GL_RGBA32F, width, height),
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

std::vector<gpu::vec4> Sprites::shade(const View& view, const LightField& light) const {
    const auto normals = normals_.read_floats(GL_RGBA, 4);
    const auto albedos = albedos_.read_floats(GL_RGBA, 4);
    const auto depths = depths_.read_floats(GL_RED, 1);
    std::vector<std::size_t> pixels;
    std::vector<Probe> probes;
    for (std::size_t i = 0; i < depths.size(); ++i) {
        if (depths[i] <= 0.0f) continue;
        const auto width = static_cast<std::size_t>(view.width);
        const ViewRay ray = ray_through(view, static_cast<double>(i % width) + 0.5,
                                        static_cast<double>(i / width) + 0.5);
        pixels.push_back(i);
        probes.push_back({ray.origin + ray.direction * double{depths[i]},
                          {normals[4 * i], normals[4 * i + 1], normals[4 * i + 2]}});
    }
    const auto arriving = measure_light(light, probes);
    std::vector<gpu::vec4> radiance(depths.size());
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const std::size_t i = pixels[k];
        const Vec3f all = (arriving[k].direct + arriving[k].indirect) / std::numbers::pi_v<float>;
        radiance[i] = {albedos[4 * i] * all.x, albedos[4 * i + 1] * all.y,
                       albedos[4 * i + 2] * all.z, 1.0f};
    }
    return radiance;
}

}  // namespace glowworm

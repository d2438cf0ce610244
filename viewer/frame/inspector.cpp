#include "viewer/frame/inspector.h"

#include "shaders/frame_layout.h"

namespace glowworm {

void Inspector::draw(const Frame& frame, const LightField* light, const InspectorSettings& settings,
                     const Texture& target) {
    const bool octree = of_octree(settings.layer) && light != nullptr;
    if (octree) {
        if (!inspect_octree_)
            inspect_octree_.emplace(std::vector<std::string>{"inspect_octree.comp"});
        light->show_to_cones();
    }
    const Program& pass = octree ? *inspect_octree_ : inspect_;
    frame.gbuffer().bind();
    if (light != nullptr) {
        frame.shading().direct().bind_storage(BINDING_PIXEL_DIRECT);
        frame.shading().indirect().bind_storage(BINDING_PIXEL_INDIRECT);
    }
    target.bind_image(0, GL_WRITE_ONLY);
    set_uniform(pass, 0, static_cast<float>(settings.stops));
    set_uniform(pass, 1, static_cast<std::uint32_t>(settings.curve));
    set_uniform(pass, 2, static_cast<std::uint32_t>(settings.layer));
    if (octree) set_uniform(pass, 3, static_cast<std::int32_t>(settings.level));
    pass.use();
    glDispatchCompute(static_cast<GLuint>(target.width() + 7) / 8,
                      static_cast<GLuint>(target.height() + 7) / 8, 1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

}  // namespace glowworm

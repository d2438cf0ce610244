#include "viewer/app/inspector.h"

#include "shaders/frame_layout.h"

namespace glowworm {

void Inspector::draw(const Frame& frame, Layer layer, const Texture& target, double stops,
                     ToneCurve curve) {
    frame.gbuffer().bind();
    frame.shading().direct().bind_storage(BINDING_PIXEL_DIRECT);
    frame.shading().indirect().bind_storage(BINDING_PIXEL_INDIRECT);
    target.bind_image(0, GL_WRITE_ONLY);
    set_uniform(inspect_, 0, static_cast<float>(stops));
    set_uniform(inspect_, 1, static_cast<std::uint32_t>(curve));
    set_uniform(inspect_, 2, static_cast<std::uint32_t>(layer));
    inspect_.use();
    glDispatchCompute(static_cast<GLuint>(target.width() + 7) / 8,
                      static_cast<GLuint>(target.height() + 7) / 8, 1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

}  // namespace glowworm

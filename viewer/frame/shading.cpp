#include "viewer/frame/shading.h"

#include "shaders/frame_layout.h"

namespace glowworm {
namespace {

gpu::vec4 vec4_of(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0.0f};
}

}  // namespace

void Shading::set_panels(std::span<const AreaLight> panels, const Vec3d& origin) {
    std::vector<gpu::Panel> records;
    for (const AreaLight& panel : panels) {
        records.push_back({vec4_of(panel.corners[0] - origin),
                           vec4_of(panel.corners[1] - panel.corners[0]),
                           vec4_of(panel.corners[3] - panel.corners[0]),
                           vec4_of(vec3_cast<double>(panel.radiance))});
    }
    panels_ = Buffer::of("visible panels", std::span<const gpu::Panel>(records));
    panel_count_ = static_cast<std::uint32_t>(records.size());
}

void Shading::draw(const GBuffer& gbuffer, const LightField& light, const View& view,
                   int sub_pixels) {
    const auto width = static_cast<GLuint>(view.width), height = static_cast<GLuint>(view.height);
    const std::size_t bytes = std::size_t{width} * height * sizeof(gpu::vec4);
    if (beauty_.bytes() != bytes) {
        direct_ = Buffer("pixel direct", bytes);
        indirect_ = Buffer("pixel indirect", bytes);
        emission_ = Buffer("pixel emission", bytes);
        beauty_ = Buffer("pixel beauty", bytes);
    }

    light.bind();
    gbuffer.bind();
    panels_.bind_storage(BINDING_PANELS);
    direct_.bind_storage(BINDING_PIXEL_DIRECT);
    indirect_.bind_storage(BINDING_PIXEL_INDIRECT);
    emission_.bind_storage(BINDING_PIXEL_EMISSION);
    beauty_.bind_storage(BINDING_PIXEL_BEAUTY);
    set_uniform(shade_, 0, panel_count_);
    set_uniform(shade_, 1, static_cast<std::int32_t>(sub_pixels));
    shade_.use();
    glDispatchCompute((width + 7) / 8, (height + 7) / 8, 1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

}  // namespace glowworm

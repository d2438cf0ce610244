#include "viewer/frame/shading.h"

#include <algorithm>

#include "shaders/frame_layout.h"
#include "viewer/gpu/context.h"

namespace glowworm {
namespace {

gpu::vec4 vec4_of(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0.0f};
}

/// shade_corners.glsl: corners_of_view(), along one edge.
std::size_t corners_of(int pixels) {
    return static_cast<std::size_t>(pixels / SHADE_TILE + 2);
}

constexpr std::int32_t kLookRow = -1;  // shade_light.comp: how much of the light is seen

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
                   int sub_pixels, float wetness) {
    const std::size_t bytes = static_cast<std::size_t>(view.width) *
                              static_cast<std::size_t>(view.height) * sizeof(gpu::vec4);
    if (layers_.beauty.bytes() != bytes) {
        layers_ = {Buffer("pixel direct", bytes), Buffer("pixel indirect", bytes),
                   Buffer("pixel specular", bytes), Buffer("pixel emission", bytes),
                   Buffer("pixel beauty", bytes)};
        pixel_lamps_ = Buffer("pixel lamps", bytes / 2);
    }
    const std::size_t corners = corners_of(view.width) * corners_of(view.height);
    if (corners_.bytes() != corners * sizeof(gpu::CornerLight))
        corners_ = Buffer("corner lights", corners * sizeof(gpu::CornerLight));
    if (runs_on_cpu() && !shaders_forced_) {
        const bool wet = wetness > 0.0f && light.fits_shaders();  // which filter what is mirrored
        shade_on_cpu(gbuffer, light,
                     {panels_, panel_count_, corners_, pixel_lamps_, sub_pixels,
                      wet ? wetness : 0.0f, wet ? &light.show_to_cones() : nullptr},
                     layers_);
    } else {
        draw_by_shaders(gbuffer, light, view, sub_pixels, wetness);
    }
}

void Shading::draw_by_shaders(const GBuffer& gbuffer, const LightField& light, const View& view,
                              int sub_pixels, float wetness) {
    const auto width = static_cast<GLuint>(view.width), height = static_cast<GLuint>(view.height);
    if (wetness > 0.0f) {
        if (!wet_) wet_.emplace(std::vector<std::string>{"WET"});
        light.show_to_cones();
    }
    const Passes& passes = wetness > 0.0f ? *wet_ : dry_;

    const Buffer& looks = light.direct().lamp_looks();
    light.direct().look_at_lamps();
    light.bind();
    looks.bind_storage(BINDING_LAMP_LOOKS);
    gbuffer.bind();
    panels_.bind_storage(BINDING_PANELS);
    layers_.direct.bind_storage(BINDING_PIXEL_DIRECT);
    layers_.indirect.bind_storage(BINDING_PIXEL_INDIRECT);
    layers_.specular.bind_storage(BINDING_PIXEL_SPECULAR);
    layers_.emission.bind_storage(BINDING_PIXEL_EMISSION);
    layers_.beauty.bind_storage(BINDING_PIXEL_BEAUTY);
    corners_.bind_storage(BINDING_CORNERS);
    pixel_lamps_.bind_storage(BINDING_PIXEL_LAMPS);
    const auto run = [&](const Program& pass) {
        pass.use();
        glDispatchCompute((width + 7) / 8, (height + 7) / 8, 1);
        glMemoryBarrier(GL_ALL_BARRIER_BITS);
    };
    const auto look_up_lamps = [&](std::uint32_t group) {
        set_uniform(corners_pass_, 0, group);
        set_uniform(corners_pass_, 1, looks.bytes() > 0 ? 1u : 0u);
        corners_pass_.use();
        glDispatchCompute((width / SHADE_TILE + 9) / 8, (height / SHADE_TILE + 9) / 8, 1);
        glMemoryBarrier(GL_ALL_BARRIER_BITS);
        run(lamps_pass_);
    };
    look_up_lamps(0);
    set_uniform(passes.surface, 0, panel_count_);
    set_uniform(passes.surface, 1, wetness);
    run(passes.surface);

    set_uniform(passes.light, 3, static_cast<std::int32_t>(sub_pixels));
    set_uniform(passes.light, 4, wetness);
    const std::int32_t rows = (AREA_SAMPLES_OF_SURFACE + sub_pixels - 1) / sub_pixels;
    for (std::uint32_t i = 0; i < light.direct().lights().size(); ++i) {
        if (i > 0 && i % LAMPS_IN_GROUP == 0 && looks.bytes() > 0)
            look_up_lamps(i / LAMPS_IN_GROUP);
        set_uniform(passes.light, 0, i);
        const bool area = light.direct().lights()[i].kind == LIGHT_AREA;
        set_uniform(passes.light, 1, kLookRow);
        run(passes.light);
        for (std::int32_t row = 0; row < (area ? rows : 1); row += AREA_ROWS_AT_ONCE) {
            set_uniform(passes.light, 1, row);
            set_uniform(passes.light, 2, std::min(row + AREA_ROWS_AT_ONCE, rows));
            run(passes.light);
        }
    }
}

}  // namespace glowworm

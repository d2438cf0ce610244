#pragma once

#include "viewer/frame/gbuffer.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// Where shading puts its layers, [pixels] vec4 each.
struct ShadedLayers {
    Buffer direct, indirect, specular, emission, beauty;
};

/// What shading takes besides the G-buffer and the light.
struct ShadePassInput {
    const Buffer& panels;  ///< Panel
    std::uint32_t panel_count = 0;
    const Buffer& corners;                 ///< CornerLight, shade_corners.glsl
    const Buffer& pixel_lamps;             ///< [pixels] uvec2, shade_corners.glsl
    int sub_pixels = 1;                    ///< Shading::draw
    float wetness = 0.0f;                  ///< Shading::draw
    const ConeGather* mirrored = nullptr;  ///< LightField::show_to_cones() where walls are wet
};

/// Twin of shade.comp and shade_light.comp where OpenGL runs on the CPU: the same
/// formulas as compiled code, on all cores, the same on any number of them.
void shade_on_cpu(const GBuffer& gbuffer, const LightField& light, const ShadePassInput& input,
                  const ShadedLayers& layers);

}  // namespace glowworm

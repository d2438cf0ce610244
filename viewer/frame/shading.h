#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "octree/surfel.h"
#include "viewer/frame/gbuffer.h"
#include "viewer/frame/shade_pass.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// Light on the G-buffer's surfaces, each layer by itself: direct with traced shadows, indirect
/// from the leaves around, what wet walls mirror, and area lights as the rectangles they are.
class Shading {
  public:
    Shading() = default;

    /// What emits and is seen; `origin` is the octree's, m, world.
    void set_panels(std::span<const AreaLight> panels, const Vec3d& origin);

    /// Shades `view`'s pixels; where a panel is in front it takes the surface's place. Squares of
    /// `sub_pixels` x `sub_pixels` from the first on will be averaged: they share the samples of
    /// area lights. `wetness`, 0..1: how much of the walls a film of water covers.
    void draw(const GBuffer& gbuffer, const LightField& light, const View& view, int sub_pixels = 1,
              float wetness = 0.0f);

    /// [pixels] vec4 of radiance, W·sr⁻¹·m⁻².
    const Buffer& direct() const { return layers_.direct; }
    const Buffer& indirect() const { return layers_.indirect; }
    const Buffer& specular() const { return layers_.specular; }
    const Buffer& emission() const { return layers_.emission; }
    /// Their sum; w: 1 where a surface was hit.
    const Buffer& beauty() const { return layers_.beauty; }

    /// Frame::force_shaders
    void force_shaders(bool force) { shaders_forced_ = force; }

  private:
    struct Passes {
        Program surface, light;
        explicit Passes(const std::vector<std::string>& defines)
            : surface({"shade.comp"}, defines), light({"shade_light.comp"}, defines) {}
    };

    void draw_by_shaders(const GBuffer& gbuffer, const LightField& light, const View& view,
                         int sub_pixels, float wetness);

    Passes dry_{{}};
    std::optional<Passes> wet_;  // compiled when first asked for
    ShadedLayers layers_;
    Buffer panels_;
    Buffer corners_;      // CornerLight where squares of SHADE_TILE pixels meet
    Buffer pixel_lamps_;  // [pixels] uvec2, of one group of lamps
    Program corners_pass_{{"shade_corners.comp"}}, lamps_pass_{{"pixel_lamps.comp"}};
    std::uint32_t panel_count_ = 0;
    bool shaders_forced_ = false;
};

}  // namespace glowworm

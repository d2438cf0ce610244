#include "viewer/frame/shade_pass.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "viewer/gpu/glsl.h"

namespace glowworm {
namespace gpu {
namespace {

/// The pixels of a frame, shaded a tile at a time.
struct ShadePass {
    std::span<const Node> nodes;
    std::span<const Lobe> lobes;
    std::span<const LobeLight> lobe_lights;
    std::span<const Light> lights;
    std::span<const Panel> panels;
    std::span<vec4> surfaces, albedos, direct, indirect, specular, emission, beauty;
    std::span<CornerLight> corners;
    LightGrid grid;
    ViewBlock view;
    uint panel_count, light;
    int sub_pixels;
    float wetness;

#include "shaders/shade_light.glsl"
#include "shaders/shade_surface.glsl"

    template <typename Visit>
    void for_each_pixel(uvec2 corner, const Visit& visit) const {
        for (uint y = corner.y; y < std::min(corner.y + kTile, view.height); ++y) {
            for (uint x = corner.x; x < std::min(corner.x + kTile, view.width); ++x)
                visit(uvec2(x, y));
        }
    }

    /// shade_light.comp's look_together().
    void look_together(uvec2 corner) {
        uint tile_seen = 0, tile_hidden = 0;
        const Pixel first = pixel_at(corner);
        if (can_be_lit(first)) {
            for_each_pixel(corner, [&](uvec2 at) {
                const Pixel pixel = pixel_at(at);
                if (!can_be_lit(pixel)) return;
                uint seen, hidden;
                look(pixel, at.y % kTile * kTile + at.x % kTile, first.surface, seen, hidden);
                tile_seen += seen;
                tile_hidden += hidden;
            });
        }
        const float seen = how_much_seen(tile_seen, tile_hidden);
        for_each_pixel(corner, [&](uvec2 at) { direct[at.y * view.width + at.x].w = seen; });
    }

    void shade_tile(uvec2 corner) {
        for_each_pixel(corner, [&](uvec2 at) { shade_surface(at); });
        for (light = 0; light < lights.size(); ++light) {
            const bool area = lights[light].kind == LIGHT_AREA;
            if (area) look_together(corner);
            const int rows = area ? AREA_SAMPLES : 1;
            for_each_pixel(corner, [&](uvec2 at) { shade_light(at, 0, rows); });
        }
    }
};

}  // namespace
}  // namespace gpu

void shade_on_cpu(const GBuffer& gbuffer, const LightField& light, const ShadePassInput& input,
                  const ShadedLayers& layers) {
    using gpu::vec4;
    const auto nodes = light.octree().nodes.map<const Node>();
    const auto lobes = light.octree().lobes.map<const Lobe>();
    const auto lobe_lights = light.lobe_lights().map<const gpu::LobeLight>();
    const auto panels = input.panels.map<const gpu::Panel>();
    const auto surfaces = gbuffer.surfaces().map<vec4>(), albedos = gbuffer.albedos().map<vec4>();
    const auto direct = layers.direct.map<vec4>(), indirect = layers.indirect.map<vec4>();
    const auto specular = layers.specular.map<vec4>(), emission = layers.emission.map<vec4>();
    const auto beauty = layers.beauty.map<vec4>();
    const auto corners = input.corners.map<gpu::CornerLight>();
    const gpu::ShadePass frame{.nodes = nodes,
                               .lobes = lobes,
                               .lobe_lights = lobe_lights,
                               .lights = light.lights(),
                               .panels = panels,
                               .surfaces = surfaces,
                               .albedos = albedos,
                               .direct = direct,
                               .indirect = indirect,
                               .specular = specular,
                               .emission = emission,
                               .beauty = beauty,
                               .corners = corners,
                               .grid = light.octree().grid,
                               .view = gbuffer.view_block(),
                               .panel_count = input.panel_count,
                               .sub_pixels = input.sub_pixels};
    // Each task works on a copy of the pass.
    const auto parallel = [&](gpu::uvec2 count, gpu::uint grain, const auto& visit) {
        tbb::parallel_for(
            tbb::blocked_range2d<gpu::uint>(0, count.y, grain, 0, count.x, grain),
            [&](const auto& range) {
                gpu::ShadePass pass = frame;
                for (gpu::uint y = range.rows().begin(); y < range.rows().end(); ++y) {
                    for (gpu::uint x = range.cols().begin(); x < range.cols().end(); ++x)
                        visit(pass, gpu::uvec2(x, y));
                }
            });
    };
    const gpu::uvec2 count = gpu::ShadePass(frame).corners_of_view();
    parallel(count, 8, [&](gpu::ShadePass& pass, gpu::uvec2 corner) {
        pass.corners[corner.y * count.x + corner.x] = pass.light_of_corner(corner);
    });
    constexpr gpu::uint kTile = gpu::ShadePass::kTile;
    const gpu::uvec2 tiles =
        (gpu::uvec2(frame.view.width, frame.view.height) + (kTile - 1)) / gpu::uint{kTile};
    parallel(tiles, 8, [&](gpu::ShadePass& pass, gpu::uvec2 tile) {
        pass.shade_tile(gpu::uint{kTile} * tile);
    });
}

}  // namespace glowworm

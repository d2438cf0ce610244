#include "viewer/frame/shade_pass.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <optional>

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
    std::span<uvec2> pixel_lamps;
    std::span<std::uint64_t> lamp_looks;  // empty where lobes have not looked
    LightGrid grid;
    ViewBlock view;
    uint panel_count, light, lamp_group;
    int sub_pixels;
    float wetness;

#include "shaders/shade_light.glsl"

#include "shaders/corner_light.glsl"
#include "shaders/lamp_looks.glsl"
#include "shaders/shade_surface.glsl"

    uint end_of_group() const {
        return std::min(LAMPS_IN_GROUP * (lamp_group + 1), static_cast<uint>(lights.size()));
    }

    /// A lobe looks when somebody asks first. What it sees depends on nothing else, so it does not
    /// matter which thread that is.
    uvec2 looks_of(uint lobe) {
        if (lamp_looks.empty()) return uvec2(0);
        const std::atomic_ref<std::uint64_t> kept(lamp_looks[lamp_group * lobes.size() + lobe]);
        const std::uint64_t looks = kept.load(std::memory_order_relaxed);
        uvec2 known(static_cast<uint>(looks), static_cast<uint>(looks >> 32));
        for (uint lamp = LAMPS_IN_GROUP * lamp_group; lamp < end_of_group(); ++lamp) {
            if (((known.x | known.y) & lamp_bit(lamp)) == 0) known |= look_at_lamp(lobe, lamp);
        }
        const std::uint64_t all = std::uint64_t{known.y} << 32 | known.x;
        if (all != looks) kept.store(all, std::memory_order_relaxed);
        return known;
    }

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
        for_each_pixel(corner, [&](uvec2 at) {
            const Pixel pixel = pixel_at(at);
            pixel_lamps[pixel.index] = lamps_between_corners(pixel, at);
            if (lamp_group == 0) shade_surface(at);
        });
        for (light = LAMPS_IN_GROUP * lamp_group; light < end_of_group(); ++light) {
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
    const auto pixel_lamps = input.pixel_lamps.map<gpu::uvec2>();
    const Buffer& looks = light.direct().lamp_looks();
    std::optional<Mapped<std::uint64_t>> lamp_looks;
    if (looks.bytes() > 0) lamp_looks.emplace(looks.map<std::uint64_t>());
    gpu::ShadePass frame{.nodes = nodes,
                         .lobes = lobes,
                         .lobe_lights = lobe_lights,
                         .lights = light.direct().lights(),
                         .panels = panels,
                         .surfaces = surfaces,
                         .albedos = albedos,
                         .direct = direct,
                         .indirect = indirect,
                         .specular = specular,
                         .emission = emission,
                         .beauty = beauty,
                         .corners = corners,
                         .pixel_lamps = pixel_lamps,
                         .lamp_looks = {},
                         .grid = light.octree().grid,
                         .view = gbuffer.view_block(),
                         .panel_count = input.panel_count,
                         .light = 0,
                         .lamp_group = 0,
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
    if (lamp_looks) frame.lamp_looks = *lamp_looks;
    const gpu::uvec2 count = frame.corners_of_view();
    constexpr gpu::uint kTile = gpu::ShadePass::kTile;
    const gpu::uvec2 tiles =
        (gpu::uvec2(frame.view.width, frame.view.height) + (kTile - 1)) / gpu::uint{kTile};
    do {
        parallel(count, 8, [&](gpu::ShadePass& pass, gpu::uvec2 corner) {
            pass.corners[corner.y * count.x + corner.x] = pass.light_of_corner(corner);
        });
        parallel(tiles, 8, [&](gpu::ShadePass& pass, gpu::uvec2 tile) {
            pass.shade_tile(gpu::uint{kTile} * tile);
        });
    } while (LAMPS_IN_GROUP * ++frame.lamp_group < light.direct().lights().size());
}

}  // namespace glowworm

#include "viewer/frame/shade_pass.h"

#include <tbb/blocked_range2d.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>

#include "viewer/frame/shade_topics.h"

namespace glowworm {
namespace gpu {

PixelRow ShadeTopics::shade_row(uvec2 at, uint count) {
    Pixel pixels[kLanes];
    PixelRow row{};
    Vec3s sum{};
    Vec3s &position = row.position, &normal = row.normal;
    Floats place{}, shares{}, lamp_shares{};
    Words seen = ~Words{}, hidden = ~Words{};
    for (uint lane = 0; lane < kLanes; ++lane) {
        Pixel& pixel = pixels[lane];
        pixel = pixel_at(at + uvec2(std::min(lane, count - 1), 0u));
        for (int axis = 0; axis < 3; ++axis) {
            position[axis][lane] = pixel.position[axis];
            normal[axis][lane] = pixel.surface[axis];
        }
        place[lane] = place_in_square(at.x + lane);
    }
    ask_corners(position, normal, place, place_in_square(at.y), first_corner(at), sum, shares, seen,
                hidden, lamp_shares);
    for (uint lane = 0; lane < count; ++lane) {
        const Pixel& pixel = pixels[lane];
        const bool hit = pixel.surface.w > 0.0f;
        const uvec2 lamps =
            hit ? lamps_of_pixel(seen[lane], hidden[lane], lamp_shares[lane]) : uvec2(0u);
        pixel_lamps[pixel.index] = lamps;
        row.seen[lane] = lamps.x;
        row.hidden[lane] = lamps.y;
        if (lamp_group == 0) {
            const vec3 reflected(sum.x[lane], sum.y[lane], sum.z[lane]);
            shade_surface(pixel,
                          hit ? irradiance_of_pixel(pixel, reflected, shares[lane]) : vec3(0.0f));
        }
        row.lit[lane] = can_be_lit(pixel) ? 1.0f : 0.0f;
    }
    return row;
}

void ShadeTopics::shade_block(uvec2 begin, uvec2 end) {
    rows.resize(kBlock * kRows);
    for_each_row(begin, end, [&](PixelRow& row, uvec2 first) {
        row = shade_row(first, std::min(uint{kLanes}, end.x - first.x));
    });
    for (light = first_of_group(); light < end_of_group(); ++light) {
        if (lights[light].kind == LIGHT_AREA || wetness > 0.0f) {
            add_light(begin, end);
        } else {
            add_lamp(begin, end);
        }
    }
    add_lamps_to_pixels(begin, end);
}

}  // namespace gpu

void shade_on_cpu(const GBuffer& gbuffer, const LightField& light, const ShadePassInput& input,
                  const ShadedLayers& layers) {
    using gpu::vec4;
    const RayTracer& tracer = *light.direct().tracer();  // which maps what is mapped below
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
    std::optional<std::span<std::uint64_t>> lamp_looks;
    if (looks.bytes() > 0) lamp_looks.emplace(looks.map<std::uint64_t>());
    gpu::ShadeTopics frame{
        .nodes = nodes,
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
        .sub_pixels = input.sub_pixels,
        .wetness = input.wetness,
        .shadows = ShadowQueue(&tracer),
        .near_lobes = {nodes, lobes, lobe_lights, static_cast<int>(light.octree().grid.depth)}};
    if (lamp_looks) frame.lamp_looks = *lamp_looks;
    if (input.mirrored != nullptr) {
        frame.sides = input.mirrored->sides().map<const gpu::uvec2>();
        frame.dense = input.mirrored->coarse_cells().map<const gpu::uint>();
    }
    // Each thread works on a copy of the pass.
    const auto in_blocks = [&](gpu::uvec2 size, gpu::uint edge, const auto& work) {
        tbb::enumerable_thread_specific<gpu::ShadeTopics> passes(frame);
        const gpu::uvec2 blocks = (size + (edge - 1)) / edge;
        tbb::parallel_for(
            tbb::blocked_range2d<gpu::uint>(0, blocks.y, 0, blocks.x), [&](const auto& range) {
                gpu::ShadeTopics& pass = passes.local();
                for (gpu::uint y = range.rows().begin(); y < range.rows().end(); ++y) {
                    for (gpu::uint x = range.cols().begin(); x < range.cols().end(); ++x) {
                        const gpu::uvec2 begin = edge * gpu::uvec2(x, y);
                        work(pass, begin, gpu::min(begin + edge, size));
                    }
                }
            });
    };
    do {
        in_blocks(frame.corners_of_view(), gpu::ShadeTopics::kBlock / SHADE_TILE,
                  [](gpu::ShadeTopics& pass, gpu::uvec2 begin, gpu::uvec2 end) {
                      pass.shade_corners(begin, end);
                  });
        in_blocks({frame.view.width, frame.view.height}, gpu::ShadeTopics::kBlock,
                  [](gpu::ShadeTopics& pass, gpu::uvec2 begin, gpu::uvec2 end) {
                      pass.shade_block(begin, end);
                  });
    } while (LAMPS_IN_GROUP * ++frame.lamp_group < light.direct().lights().size());
}

}  // namespace glowworm

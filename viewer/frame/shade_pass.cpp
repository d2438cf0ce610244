#include "viewer/frame/shade_pass.h"

#include <tbb/blocked_range2d.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <vector>

#include "viewer/gpu/lanes.h"
#include "viewer/light/lobes_near.h"
#include "viewer/light/shadow_queue.h"

namespace glowworm {
namespace gpu {
namespace {

constexpr uint kBlock = 32;  // pixels along the edge of what one thread shades at once
constexpr uint kRows = kBlock / kLanes;

/// Pixels side by side in a row of a block, for the lamps without extent.
struct PixelRow {
    Vec3s position, normal;
    Words seen, hidden;  // ShadePass::pixel_lamps
    Floats lit;          // 1 where light can fall, else 0
    Vec3s sum;           // irradiance, W/m2
    Floats share;        // of the lamp at hand
    Ints open;           // where that is not known to be seen or hidden
};

/// The pixels of a frame, a block of them at a time, whose shadow rays are traced together.
struct ShadePass {
    std::span<const Node> nodes;
    std::span<const Lobe> lobes;
    std::span<const LobeLight> lobe_lights;
    std::span<const Light> lights;
    std::span<const Panel> panels;
    std::span<vec4> surfaces, albedos, direct, indirect, specular, emission, beauty;
    std::span<CornerLight> corners;
    std::span<uvec2> pixel_lamps;
    std::span<std::uint64_t> lamp_looks;  // empty where lobes do not look
    LightGrid grid;
    ViewBlock view;
    uint panel_count, light, lamp_group;
    int sub_pixels;
    float wetness;
    ShadowQueue shadows;
    LobesNear near_lobes;
    std::vector<uint> noted = {};        // lobes round corners, those of one after the other
    std::vector<std::size_t> ends = {};  // of each corner's
    std::vector<uvec2> asking = {};      // pixels, or tiles' first ones, that wait for rays
    std::vector<PixelRow> rows = {};     // of the block at hand, kRows for each of its rows

    std::span<const uvec2> sides = {};  // of wet walls alone
    std::span<const uint> dense = {};

#define UNOCCLUDED shadows.unoccluded
#define WET
#include "shaders/shade_light.glsl"

#define LIGHT_AROUND light_around
#include "shaders/corner_light.glsl"
#include "shaders/lamp_looks.glsl"
#include "shaders/shade_surface.glsl"

    uint first_of_group() const {
        return LAMPS_IN_GROUP * lamp_group;
    }
    uint end_of_group() const {
        return std::min(first_of_group() + LAMPS_IN_GROUP, static_cast<uint>(lights.size()));
    }

    void note_lobe(uint lobe) {
        noted.push_back(lobe);
    }

    /// light_lookup.glsl's, kLanes lobes at once, for a lookup's width and without a wall.
    LobeLight light_around(vec3 position, vec3 normal, float, bool tricubic, uint) {
        const bool turning = (grid.flags & LIGHT_FLAG_FAITHFUL) == 0u;
        const vec3 most(static_cast<float>(1 << grid.depth) + 8.0f);
        vec3 at = (position - cube_min()) / grid.voxel_size - 0.5f;
        at = clamp(at, vec3(-8.0f), most);
        const ivec3 low = ivec3(floor(at)) - (tricubic ? 1 : 0);
        const LobesNear::Lobes& near = near_lobes.in_leaves(low, low + (tricubic ? 3 : 1));
        LobesNear::Light sum{};
        for (std::size_t first = 0; first < near.lights.size(); first += kLanes) {
            const LobesNear::Group& group = near.groups[first / kLanes];
            const Floats cosine = dot(group.normal, normal);
            const Floats likeness =
                facing_weight(cosine) * plane_weight(dot(group.position - position, normal));
            const Floats weight = lookup_weight(group.cell[0] - at.x, tricubic) *
                                  lookup_weight(group.cell[1] - at.y, tricubic) *
                                  lookup_weight(group.cell[2] - at.z, tricubic) * likeness;
            const Vec3s tilt = normal - cosine * group.normal;
            for (int lane = 0; lane < kLanes; ++lane) {
                if (!(weight[lane] > 0.0f)) continue;
                EACH_LOBE(group.lobe[lane], likeness[lane]);
                const auto& lobe = near.lights[first + static_cast<std::size_t>(lane)];
                Floats irradiance = lobe.irradiance;
                float share = weight[lane];
                if (turning) {
                    const auto wall = static_cast<uint>(lobe.irradiance[3]);
                    if (wall != 0u && wall_between(wall, lobe_position(group.lobe[lane]), position))
                        share *= kThroughWall;
                    irradiance =
                        0.5f * (1.0f + cosine[lane]) * lobe.irradiance +
                        (tilt.x[lane] * lobe.along[0] + tilt.y[lane] * lobe.along[1] +
                         tilt.z[lane] * lobe.along[2] + 0.5f * (1.0f - cosine[lane]) * lobe.around);
                    irradiance = max(irradiance, 0.0f);
                }
                irradiance[3] = 1.0f;
                sum.irradiance += share * irradiance;
                for (int axis = 0; axis < 3; ++axis)
                    sum.along[axis] += share * lobe.along[axis];
                sum.around += share * lobe.around;
            }
        }
        const float weights = sum.irradiance[3];
        const float scale = weights > 0.0f ? 1.0f / weights : 0.0f;
        LobeLight found;
        for (int c = 0; c < 3; ++c) {
            found.irradiance[c] = scale * sum.irradiance[c];
            found.turn[c] =
                scale * vec4(sum.along[0][c], sum.along[1][c], sum.along[2][c], sum.around[c]);
        }
        found.irradiance.w = weights;
        return found;
    }

    /// What a lobe is known to see and not to see of the group's lamps.
    uvec2 looks_of(uint lobe) const {
        const std::atomic_ref<std::uint64_t> kept(lamp_looks[lamp_group * lobes.size() + lobe]);
        const std::uint64_t looks = kept.load(std::memory_order_relaxed);
        return uvec2(static_cast<uint>(looks), static_cast<uint>(looks >> 32));
    }

    /// Those of `lookers` that have not yet look at all the group's lamps. What they see depends on
    /// nothing else, so it does not matter which thread comes first.
    void have_look(std::vector<uint> lookers) {
        std::erase_if(lookers, [&](uint lobe) { return looks_of(lobe) != uvec2(0u); });
        std::ranges::sort(lookers);
        const auto same = std::ranges::unique(lookers);
        lookers.erase(same.begin(), same.end());
        std::vector<uvec2> looks(lookers.size());
        std::vector<std::size_t> rays(lookers.size());
        for (uint lamp = first_of_group(); lamp < end_of_group(); ++lamp) {
            for (std::size_t first = 0, last = 0; first < lookers.size(); first = last) {
                shadows.ask();
                for (; last < lookers.size() && !shadows.is_full(); ++last) {
                    rays[last] = shadows.asked();
                    look_at_lamp(lookers[last], lamp);
                }
                shadows.trace();
                for (std::size_t i = first; i < last; ++i) {
                    shadows.answer_from(rays[i]);
                    looks[i] |= look_at_lamp(lookers[i], lamp);
                }
            }
        }
        for (std::size_t i = 0; i < lookers.size(); ++i) {
            std::atomic_ref<std::uint64_t>(lamp_looks[lamp_group * lobes.size() + lookers[i]])
                .store(std::uint64_t{looks[i].y} << 32 | looks[i].x, std::memory_order_relaxed);
        }
    }

    void shade_corners(uvec2 begin, uvec2 end) {
        const auto for_each_corner = [&](const auto& visit) {
            for (uint y = begin.y; y < end.y; ++y) {
                for (uint x = begin.x; x < end.x; ++x)
                    visit(uvec2(x, y), corners[y * corners_of_view().x + x]);
            }
        };
        noted.clear();
        ends.clear();
        for_each_corner([&](uvec2 at, CornerLight& corner) {
            corner = light_of_corner(at);
            ends.push_back(noted.size());
        });
        if (!lamp_looks.empty()) have_look(noted);
        std::size_t i = 0, lobe = 0;
        for_each_corner([&](uvec2, CornerLight& corner) {
            uint seen = 0xffffffffu, hidden = 0xffffffffu;
            for (; lobe < ends[i]; ++lobe)
                agree_with(lamp_looks.empty() ? uvec2(0u) : looks_of(noted[lobe]), seen, hidden);
            set_lamps(corner, seen, hidden);
            ++i;
        });
    }

    /// Up to kLanes pixels of a row of a square, from `at` on, before the lights themselves.
    PixelRow shade_row(uvec2 at, uint count) {
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
        ask_corners(position, normal, place, place_in_square(at.y), first_corner(at), sum, shares,
                    seen, hidden, lamp_shares);
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
                shade_surface(
                    pixel, hit ? irradiance_of_pixel(pixel, reflected, shares[lane]) : vec3(0.0f));
            }
            row.lit[lane] = can_be_lit(pixel) ? 1.0f : 0.0f;
        }
        return row;
    }

    /// Has `visit` work on what it is called with twice where it asks for shadow rays: what it
    /// makes of those that are only asked for is overwritten or nothing.
    template <typename Visit>
    void with_shadows(uvec2 at, const Visit& visit) {
        const std::size_t before = shadows.asked();
        visit(at);
        if (shadows.asked() == before) return;
        asking.push_back(at);
        if (shadows.is_full()) answer(visit);
    }
    template <typename Visit>
    void answer(const Visit& visit) {
        shadows.trace();
        for (const uvec2 at : asking)
            visit(at);
        asking.clear();
        shadows.ask();
    }

    /// shade_light.comp's look_together().
    void look_together(uvec2 tile, uvec2 end) {
        uint tile_seen = 0, tile_hidden = 0;
        const Pixel first = pixel_at(tile);
        const auto for_each_pixel = [&](const auto& visit) {
            for (uint y = tile.y; y < std::min(tile.y + kTile, end.y); ++y) {
                for (uint x = tile.x; x < std::min(tile.x + kTile, end.x); ++x)
                    visit(uvec2(x, y));
            }
        };
        if (can_be_lit(first)) {
            for_each_pixel([&](uvec2 at) {
                const Pixel pixel = pixel_at(at);
                if (!can_be_lit(pixel)) return;
                uint seen, hidden;
                look(pixel, at.y % kTile * kTile + at.x % kTile, first.surface, seen, hidden);
                tile_seen += seen;
                tile_hidden += hidden;
            });
        }
        const float seen = how_much_seen(tile_seen, tile_hidden);
        for_each_pixel([&](uvec2 at) { direct[at.y * view.width + at.x].w = seen; });
    }

    /// Has `visit` called with all of a block's rows of pixels and the first pixel of each.
    template <typename Visit>
    void for_each_row(uvec2 begin, uvec2 end, const Visit& visit) {
        for (uint y = begin.y; y < end.y; ++y) {
            for (uint x = begin.x; x < end.x; x += kLanes)
                visit(rows[(y - begin.y) * kRows + (x - begin.x) / kLanes], uvec2(x, y));
        }
    }

    /// A lamp without extent: shade_light() for all pixels of a block, some at once.
    void add_lamp(uvec2 begin, uvec2 end) {
        const Light lamp = lights[light];
        const vec3 at(lamp.position);
        bool open_tiles[kBlock / kTile][kBlock / kTile] = {};
        for_each_row(begin, end, [&](PixelRow& row, uvec2 first) {
            const Ints steep = above_grazing(row.normal, at - row.position) > 0.0f;
            const Ints seen = steep & ((row.seen & lamp_bit(light)) != 0u);
            const Ints hidden = steep & ((row.hidden & lamp_bit(light)) != 0u) & ~seen;
            row.share = share_of_lamp(lamp, row.position, row.normal) * row.lit;
            row.share = hidden ? Floats{} : row.share;
            row.open = (row.share > 0.0f) & ~seen;
            const uvec2 tile = (first - begin) / kTile;
            open_tiles[tile.y][tile.x] |= any_of(row.open);
        });
        const auto is_open = [&](uvec2 first) {
            const uvec2 tile = (first - begin) / kTile;
            return open_tiles[tile.y][tile.x];
        };
        shadows.ask();
        const auto look = [&](uvec2 tile) { look_together(tile, end); };
        for (uint y = begin.y; y < end.y; y += kTile) {
            for (uint x = begin.x; x < end.x; x += kTile)
                if (is_open(uvec2(x, y))) with_shadows(uvec2(x, y), look);
        }
        answer(look);
        const auto trace = [&](uvec2 pixel) {
            PixelRow& row = rows[(pixel.y - begin.y) * kRows + (pixel.x - begin.x) / kLanes];
            const uint lane = (pixel.x - begin.x) % kLanes;
            const vec3 position(row.position.x[lane], row.position.y[lane], row.position.z[lane]);
            const vec3 normal(row.normal.x[lane], row.normal.y[lane], row.normal.z[lane]);
            row.open[lane] =
                visible_from(position, normal, kPointOffset * grid.voxel_size, at, 0u, vec3(0.0f))
                    ? 0
                    : -1;
        };
        for_each_row(begin, end, [&](PixelRow& row, uvec2 first) {
            if (!is_open(first) || !any_of(row.open)) return;
            for (uint lane = 0; lane < kLanes && first.x + lane < end.x; ++lane) {
                if (row.open[lane] == 0) continue;
                const float seen = direct[first.y * view.width + first.x + lane].w;
                if (seen == kInFullView) row.open[lane] = 0;
                if (seen == kPartlySeen) with_shadows(first + uvec2(lane, 0u), trace);
            }
        });
        answer(trace);
        for_each_row(begin, end, [&](PixelRow& row, uvec2) {
            row.sum += (row.open ? Floats{} : row.share) * vec3(lamp.intensity);
        });
    }

    /// Adds up what the lamps without extent gave.
    void add_lamps_to_pixels(uvec2 begin, uvec2 end) {
        for_each_row(begin, end, [&](PixelRow& row, uvec2 first) {
            for (uint lane = 0; lane < kLanes && first.x + lane < end.x; ++lane) {
                const uint i = first.y * view.width + first.x + lane;
                const vec3 irradiance(row.sum.x[lane], row.sum.y[lane], row.sum.z[lane]);
                const vec3 reflected = kReflects * vec3{albedos[i]};
                const vec4 added(reflected * irradiance, 0.0f);
                direct[i] += added;
                beauty[i] += added;
            }
        });
    }

    /// Any light on all pixels of a block, one by one.
    void add_light(uvec2 begin, uvec2 end) {
        const bool area = lights[light].kind == LIGHT_AREA;
        shadows.ask();
        const auto look = [&](uvec2 tile) { look_together(tile, end); };
        for (uint y = begin.y; y < end.y; y += kTile) {
            for (uint x = begin.x; x < end.x; x += kTile)
                with_shadows(uvec2(x, y), look);
        }
        answer(look);
        const auto shade = [&](uvec2 at) { shade_light(at, 0, area ? AREA_SAMPLES : 1); };
        for (uint y = begin.y; y < end.y; ++y) {
            for (uint x = begin.x; x < end.x; ++x)
                with_shadows(uvec2(x, y), shade);
        }
        answer(shade);
    }

    void shade_block(uvec2 begin, uvec2 end) {
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
};

static_assert(SHADE_TILE == kLanes && kBlock % SHADE_TILE == 0 && kBlock % ShadePass::kTile == 0);

}  // namespace
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
    gpu::ShadePass frame{
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
        tbb::enumerable_thread_specific<gpu::ShadePass> passes(frame);
        const gpu::uvec2 blocks = (size + (edge - 1)) / edge;
        tbb::parallel_for(
            tbb::blocked_range2d<gpu::uint>(0, blocks.y, 0, blocks.x), [&](const auto& range) {
                gpu::ShadePass& pass = passes.local();
                for (gpu::uint y = range.rows().begin(); y < range.rows().end(); ++y) {
                    for (gpu::uint x = range.cols().begin(); x < range.cols().end(); ++x) {
                        const gpu::uvec2 begin = edge * gpu::uvec2(x, y);
                        work(pass, begin, gpu::min(begin + edge, size));
                    }
                }
            });
    };
    do {
        in_blocks(frame.corners_of_view(), gpu::kBlock / SHADE_TILE,
                  [](gpu::ShadePass& pass, gpu::uvec2 begin, gpu::uvec2 end) {
                      pass.shade_corners(begin, end);
                  });
        in_blocks({frame.view.width, frame.view.height}, gpu::kBlock,
                  [](gpu::ShadePass& pass, gpu::uvec2 begin, gpu::uvec2 end) {
                      pass.shade_block(begin, end);
                  });
    } while (LAMPS_IN_GROUP * ++frame.lamp_group < light.direct().lights().size());
}

}  // namespace glowworm

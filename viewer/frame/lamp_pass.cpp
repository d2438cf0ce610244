// The lights themselves on a block's pixels, each behind its shadows.
#include <algorithm>

#include "viewer/frame/shade_topics.h"

namespace glowworm::gpu {

void ShadeTopics::look_together(uvec2 tile, uvec2 end) {
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

void ShadeTopics::add_lamp(uvec2 begin, uvec2 end) {
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
            visible_from(position, normal, kPointOffset * grid.voxel_size, at, 0u, vec3(0.0f)) ? 0
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

void ShadeTopics::add_lamps_to_pixels(uvec2 begin, uvec2 end) {
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

void ShadeTopics::add_light(uvec2 begin, uvec2 end) {
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

}  // namespace glowworm::gpu

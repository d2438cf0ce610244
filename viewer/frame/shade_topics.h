#pragma once

// What shade_pass.cpp, corner_pass.cpp and lamp_pass.cpp work in; theirs alone.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "viewer/gpu/glsl.h"
#include "viewer/gpu/lanes.h"
#include "viewer/light/lobes_near.h"
#include "viewer/light/shadow_queue.h"

namespace glowworm::gpu {

/// Pixels side by side in a row of a block, for the lamps without extent.
struct PixelRow {
    Vec3s position, normal;
    Words seen, hidden;  // ShadeTopics::pixel_lamps
    Floats lit;          // 1 where light can fall, else 0
    Vec3s sum;           // irradiance, W/m2
    Floats share;        // of the lamp at hand
    Ints open;           // where that is not known to be seen or hidden
};

/// The pixels of a frame, a block of them at a time, whose shadow rays are traced together: what
/// the shaders bind, and what they compute with it.
struct ShadeTopics {
    static constexpr uint kBlock = 32;  // pixels along the edge of what one thread shades at once
    static constexpr uint kRows = kBlock / kLanes;

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
    /// Has `visit` called with all of a block's rows of pixels and the first pixel of each.
    template <typename Visit>
    void for_each_row(uvec2 begin, uvec2 end, const Visit& visit) {
        for (uint y = begin.y; y < end.y; ++y) {
            for (uint x = begin.x; x < end.x; x += kLanes)
                visit(rows[(y - begin.y) * kRows + (x - begin.x) / kLanes], uvec2(x, y));
        }
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

    // corner_pass.cpp
    /// light_lookup.glsl's, kLanes lobes at once, for a lookup's width and without a wall.
    LobeLight light_around(vec3 position, vec3 normal, float, bool tricubic, uint);
    /// What a lobe is known to see and not to see of the group's lamps.
    uvec2 looks_of(uint lobe) const;
    /// Those of `lookers` that have not yet look at all the group's lamps. What they see depends on
    /// nothing else, so it does not matter which thread comes first.
    void have_look(std::vector<uint> lookers);
    void shade_corners(uvec2 begin, uvec2 end);

    // lamp_pass.cpp
    /// shade_light.comp's look_together().
    void look_together(uvec2 tile, uvec2 end);
    /// A lamp without extent: shade_light() for all pixels of a block, some at once.
    void add_lamp(uvec2 begin, uvec2 end);
    /// Adds up what the lamps without extent gave.
    void add_lamps_to_pixels(uvec2 begin, uvec2 end);
    /// Any light on all pixels of a block, one by one.
    void add_light(uvec2 begin, uvec2 end);

    // shade_pass.cpp
    /// Up to kLanes pixels of a row of a square, from `at` on, before the lights themselves.
    PixelRow shade_row(uvec2 at, uint count);
    void shade_block(uvec2 begin, uvec2 end);
};

static_assert(SHADE_TILE == kLanes && ShadeTopics::kBlock % SHADE_TILE == 0 &&
              ShadeTopics::kBlock % ShadeTopics::kTile == 0);

}  // namespace glowworm::gpu

// What is looked up at the corners of squares of pixels: reflected light, and the lamps that the
// lobes round them see.
#include <algorithm>
#include <atomic>

#include "viewer/frame/shade_topics.h"

namespace glowworm::gpu {

LobeLight ShadeTopics::light_around(vec3 position, vec3 normal, float, bool tricubic, uint) {
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

uvec2 ShadeTopics::looks_of(uint lobe) const {
    const std::atomic_ref<std::uint64_t> kept(lamp_looks[lamp_group * lobes.size() + lobe]);
    const std::uint64_t looks = kept.load(std::memory_order_relaxed);
    return uvec2(static_cast<uint>(looks), static_cast<uint>(looks >> 32));
}

void ShadeTopics::have_look(std::vector<uint> lookers) {
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

void ShadeTopics::shade_corners(uvec2 begin, uvec2 end) {
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

}  // namespace glowworm::gpu

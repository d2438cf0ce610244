#include "viewer/light/group_light.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "octree/links.h"
#include "viewer/gpu/vec4.h"
#include "viewer/light/lookup.h"

namespace glowworm {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kMostAlbedo = 0.99f;  // octree.glsl

template <typename Visit>
void for_each(std::size_t count, const Visit& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 512), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            visit(i);
    });
}

Vec3f vector_of(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// lobe_reflectance() of octree.glsl.
Vec3f reflectance_of(const Lobe& lobe) {
    const float opening = std::min(length(vector_of(lobe.ndf)), 1.0f);
    Vec3f reflected;
    for (int c = 0; c < 3; ++c) {
        const float albedo = std::clamp(lobe.albedo[c], 0.0f, kMostAlbedo);
        reflected[c] = albedo * opening / (1.0f - albedo * (1.0f - opening));
    }
    return reflected;
}

/// Which groups need new links; the others get their old ones.
std::vector<std::uint32_t> keep_links(const GroupLinks& before, GroupLinks& now) {
    std::vector<std::uint32_t> changed;
    const LightGroups& groups = now.groups;
    for (std::size_t d = 0; d < groups.coarser.size(); ++d) {
        const std::uint32_t first = groups.first_of_domain[d], last = groups.first_of_domain[d + 1];
        if (before.rays == now.rays && before.groups.coarser[d] == groups.coarser[d]) {
            const std::size_t from = std::size_t{before.groups.first_of_domain[d]} * now.rays;
            std::copy_n(
                before.links.begin() + static_cast<std::ptrdiff_t>(from),
                std::size_t{last - first} * now.rays,
                now.links.begin() + static_cast<std::ptrdiff_t>(std::size_t{first} * now.rays));
            continue;
        }
        for (std::uint32_t g = first; g < last; ++g)
            changed.push_back(g);
    }
    return changed;
}

}  // namespace

GroupLinks link_groups(const OctreeView& octree, LightGroups groups, const LightSettings& settings,
                       const GroupLinks* before, const Progress& progress) {
    GroupLinks now{std::move(groups), {}, std::clamp(settings.links, 1u, 1024u)};
    now.links.resize(std::size_t{now.groups.count()} * now.rays);
    GroupLinks none;
    none.groups.coarser.assign(now.groups.coarser.size(), 0xff);
    const auto changed = keep_links(before != nullptr ? *before : none, now);
    if (changed.empty()) return now;
    if (octree.links_per_lobe >= now.rays && !octree.links.empty()) {
        for_each(changed.size(), [&](std::size_t i) {
            const std::uint32_t g = changed[i];
            for (std::uint32_t ray = 0; ray < now.rays; ++ray) {
                const std::size_t lobe = now.groups.lobe_of(g, ray);
                now.links[std::size_t{g} * now.rays + ray] =
                    octree.links[lobe * octree.links_per_lobe + ray];
            }
        });
        return now;
    }
    const auto lobe_of = [&](std::uint32_t g, std::uint32_t ray) {
        return now.groups.lobe_of(g, ray);
    };
    LinkTracer(octree, settings.trace)
        .trace({changed, 0, now.rays, now.rays, lobe_of}, now.links, progress);
    return now;
}

void radiate(std::span<const Lobe> lobes, std::span<const gpu::vec4> emitted,
             std::span<const gpu::vec4> direct, std::span<const std::uint32_t> group_of,
             std::span<const gpu::vec4> indirect, std::span<gpu::vec4> radiance) {
    for_each(lobes.size(), [&](std::size_t i) {
        const Vec3f arriving = to_vec3(direct[i]) + to_vec3(indirect[group_of[i]]);
        const Vec3f reflected = reflectance_of(lobes[i]);
        const Vec3f own = emitted.empty() ? Vec3f{} : to_vec3(emitted[i]);
        radiance[i] = {own.x + reflected.x / kPi * arriving.x,
                       own.y + reflected.y / kPi * arriving.y,
                       own.z + reflected.z / kPi * arriving.z, 0.0f};
    });
}

std::vector<gpu::LobeLight> group_gradients(const GroupLinks& links, std::span<const Lobe> lobes,
                                            std::span<const gpu::vec4> radiance,
                                            std::span<const gpu::vec4> irradiance) {
    constexpr float kLeastCosine = 0.1f;  // light_gradient.comp
    const LinkRows rows = links.rows();
    std::vector<gpu::LobeLight> lights(irradiance.size());
    for_each(lights.size(), [&](std::size_t g) {
        const auto row = rows.of(g);
        Vec3f turn[3];
        Vec3f around;
        float open = 0.0f;
        for (std::uint32_t ray = 0; ray < rows.rays; ++ray) {
            const std::uint32_t lobe = links.groups.lobe_of(static_cast<std::uint32_t>(g), ray);
            around += to_vec3(radiance[lobe]);
            if (row[ray] != kBuried) open += 1.0f;
            if (row[ray] >= radiance.size()) continue;
            const Vec3f normal = normalized(vector_of(lobes[lobe].ndf));
            const Vec3f direction = link_direction(lobe, ray, normal);
            const float cosine = dot(direction, normal);
            const Vec3f along = (direction - cosine * normal) / std::max(cosine, kLeastCosine);
            const Vec3f from = to_vec3(radiance[row[ray]]);
            for (int c = 0; c < 3; ++c)
                turn[c] += along * from[c];
        }
        gpu::LobeLight& light = lights[g];
        light.irradiance = {irradiance[g].x, irradiance[g].y, irradiance[g].z,
                            static_cast<float>(links.groups.walls[g])};
        for (int c = 0; c < 3; ++c) {
            const Vec3f scaled = turn[c] * (kPi / std::max(open, 1.0f));
            light.turn[c] = {scaled.x, scaled.y, scaled.z,
                             kPi * around[c] / static_cast<float>(rows.rays)};
        }
    });
    return lights;
}

std::vector<gpu::LobeLight> spread_to_lobes(const OctreeView& octree, const LightDomains& domains,
                                            const LightGroups& groups, std::uint32_t coarser,
                                            const gpu::LightGrid& grid,
                                            std::span<const gpu::LobeLight> lights,
                                            std::span<const gpu::vec4> radiance, bool smooth,
                                            std::vector<std::uint32_t>& lobes) {
    lobes.clear();
    std::vector<gpu::LobeLight> there;  // of the groups of those domains
    std::vector<std::uint32_t> place;   // of each lobe's group among them
    for (std::size_t d = 0; d < groups.coarser.size(); ++d) {
        if (groups.coarser[d] != coarser) continue;
        const std::uint32_t first = groups.first_of_domain[d];
        for (std::uint32_t i = domains.first_lobe_of(d); i < domains.first_lobe_of(d + 1); ++i) {
            lobes.push_back(i);
            place.push_back(static_cast<std::uint32_t>(there.size()) + groups.group_of[i] - first);
        }
        there.insert(there.end(), lights.begin() + first,
                     lights.begin() + groups.first_of_domain[d + 1]);
    }
    if (lobes.empty()) return {};
    const Octree tree = domains.tree_of(groups, coarser);
    gpu::LightGrid tree_grid = grid;
    tree_grid.depth = tree.grid.depth;
    tree_grid.voxel_size = tree.grid.voxel_size();
    tree_grid.lobe_count = static_cast<std::uint32_t>(tree.lobes.size());
    if (smooth) there = smoothed({tree.nodes, tree.lobes, there, tree_grid});
    if (coarser == 0) return there;
    std::vector<SurfacePlace> places(lobes.size());
    for_each(lobes.size(), [&](std::size_t i) {
        const Lobe& lobe = octree.lobes[lobes[i]];
        places[i] = {vector_of(lobe.position), normalized(vector_of(lobe.ndf)), place[i]};
    });
    std::vector<gpu::LobeLight> spread =
        light_at({tree.nodes, tree.lobes, there, tree_grid}, places);
    for_each(lobes.size(), [&](std::size_t i) {
        const gpu::vec4& own = radiance[lobes[i]];
        spread[i].turn[0].w = kPi * own.x;
        spread[i].turn[1].w = kPi * own.y;
        spread[i].turn[2].w = kPi * own.z;
    });
    return spread;
}

std::vector<gpu::vec4> regrouped(const LightGroups& groups, const LightGroups* before,
                                 std::span<const gpu::vec4> light) {
    std::vector<gpu::vec4> now(groups.count());
    for_each(now.size(), [&](std::size_t g) {
        float until = 0.0f;
        for (std::uint32_t m = groups.starts[g]; m < groups.starts[g + 1]; ++m) {
            const float weight = groups.share[m] - std::exchange(until, groups.share[m]);
            const std::uint32_t lobe = groups.members[m];
            const gpu::vec4& had = light[before != nullptr ? before->group_of[lobe] : lobe];
            now[g].x += weight * had.x;
            now[g].y += weight * had.y;
            now[g].z += weight * had.z;
        }
    });
    return now;
}

}  // namespace glowworm

#include "viewer/light/group_light.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "viewer/gpu/glsl.h"
#include "viewer/light/irradiance_turn.h"
#include "viewer/light/lookup.h"
#include "viewer/light/smoothing.h"

namespace glowworm {
namespace gpu {
namespace {

struct RadiatePass {
    std::span<const Lobe> lobes;
    LightGrid grid;

#include "shaders/radiate.glsl"
};

}  // namespace
}  // namespace gpu

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

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
                       const GroupLinks* before, const Progress& progress,
                       std::shared_ptr<const RayTracer> tracer) {
    GroupLinks now{std::move(groups), {}, std::clamp(settings.links, 1u, kMostLinks)};
    now.links.resize(std::size_t{now.groups.count()} * now.rays);
    GroupLinks none;
    none.groups.coarser.assign(now.groups.coarser.size(), 0xff);
    const auto changed = keep_links(before != nullptr ? *before : none, now);
    if (changed.empty()) return now;
    if (octree.links_per_lobe >= now.rays && !octree.links.empty()) {
        tbb::parallel_for(std::size_t{0}, changed.size(), [&](std::size_t i) {
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
    if (!tracer) tracer = make_ray_tracer(octree, settings.trace);
    LinkTracer(octree, std::move(tracer))
        .trace({changed, 0, now.rays, now.rays, lobe_of}, now.links, progress);
    return now;
}

void radiate(std::span<const Lobe> lobes, std::span<const gpu::vec4> emitted,
             std::span<const gpu::vec4> direct, std::span<const std::uint32_t> group_of,
             std::span<const gpu::vec4> indirect, std::span<gpu::vec4> radiance) {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, lobes.size(), 512), [&](const auto& range) {
            gpu::RadiatePass pass{lobes, {}};
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const gpu::vec3 own(emitted.empty() ? gpu::vec4(0.0f) : emitted[i]);
                const std::size_t group = group_of.empty() ? i : group_of[i];
                const gpu::vec3 arriving(direct[i] + indirect[group]);
                const auto lobe = static_cast<gpu::uint>(i);
                radiance[i] = gpu::vec4(pass.lobe_radiance(lobe, own, arriving), 0.0f);
            }
        });
}

std::vector<gpu::LobeLight> group_gradients(const GroupLinks& links, std::span<const Lobe> lobes,
                                            std::span<const gpu::vec4> radiance,
                                            std::span<const gpu::vec4> irradiance) {
    const LinkRows rows = links.rows();
    std::vector<gpu::LobeLight> lights(irradiance.size());
    tbb::parallel_for(std::size_t{0}, lights.size(), [&](std::size_t g) {
        const auto row = rows.of(g);
        IrradianceTurn turn;
        Vec3f around;
        for (std::uint32_t ray = 0; ray < rows.rays; ++ray) {
            const std::uint32_t lobe = links.groups.lobe_of(static_cast<std::uint32_t>(g), ray);
            around += to_vec3(radiance[lobe]);
            if (row[ray] < radiance.size())
                turn.add(lobe, ray, normalized(to_vec3(lobes[lobe].ndf)), radiance[row[ray]]);
        }
        lights[g] = turn.light(irradiance[g], links.groups.walls[g], open_rays(row),
                               around / static_cast<float>(rows.rays));
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
        const std::uint32_t last_lobe = domains.first_lobe_of(groups.shown[d] != 0 ? d + 1 : d);
        for (std::uint32_t i = domains.first_lobe_of(d); i < last_lobe; ++i) {
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
    if (coarser == 0) {  // each lobe's own
        std::vector<gpu::LobeLight> own;
        for (const std::uint32_t group : place)
            own.push_back(there[group]);
        return own;
    }
    std::vector<SurfacePlace> places(lobes.size());
    tbb::parallel_for(std::size_t{0}, lobes.size(), [&](std::size_t i) {
        const Lobe& lobe = octree.lobes[lobes[i]];
        places[i] = {to_vec3(lobe.position), normalized(to_vec3(lobe.ndf)), place[i]};
    });
    std::vector<gpu::LobeLight> spread =
        light_at({tree.nodes, tree.lobes, there, tree_grid}, places);
    tbb::parallel_for(std::size_t{0}, lobes.size(), [&](std::size_t i) {
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
    tbb::parallel_for(std::size_t{0}, now.size(), [&](std::size_t g) {
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

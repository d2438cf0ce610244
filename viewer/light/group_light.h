#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "octree/progress.h"
#include "octree/ray_tracer.h"
#include "shaders/gpu_layout.h"
#include "viewer/light/bounce.h"
#include "viewer/light/domains.h"
#include "viewer/light/settings.h"

namespace glowworm {

/// Groups of lobes and the links that light goes along to them.
struct GroupLinks {
    LightGroups groups;
    std::vector<std::uint32_t> links;  ///< [groups x rays] lobe, kNoHit or kBuried
    std::uint32_t rays = 0;

    LinkRows rows() const { return {links, rays, rays}; }
};

/// What of `before` still holds is kept: the groups of domains that stay as coarse as they were.
/// Others take the rays of their lobes from the octree's baked links, where there are as many, else
/// they are traced, on all cores, by `tracer` where there is one already. `progress` counts groups
/// and may throw to cancel.
GroupLinks link_groups(const OctreeView& octree, LightGroups groups, const LightSettings& settings,
                       const GroupLinks* before = nullptr, const Progress& progress = {},
                       std::shared_ptr<const RayTracer> tracer = nullptr);

/// [lobes] radiance that each sends out, W·sr⁻¹·m⁻²: radiate.comp, where `indirect` light is that
/// of groups, or with no `group_of` of lobes. All for some consecutive lobes of an octree;
/// `emitted` is empty where nothing does.
void radiate(std::span<const Lobe> lobes, std::span<const gpu::vec4> emitted,
             std::span<const gpu::vec4> direct, std::span<const std::uint32_t> group_of,
             std::span<const gpu::vec4> indirect, std::span<gpu::vec4> radiance);

/// [groups] irradiance of each, and how it changes as the surface turns.
std::vector<gpu::LobeLight> group_gradients(const GroupLinks& links, std::span<const Lobe> lobes,
                                            std::span<const gpu::vec4> radiance,
                                            std::span<const gpu::vec4> irradiance);

/// [lobes of shown `coarser` domains] light of the groups there, read between them at each of
/// their lobes; with `smooth` the noise of their rays is spread over neighbours first. `grid` is
/// the octree's. `lobes` becomes those lobes' numbers, ascending; the w of an irradiance means
/// nothing.
std::vector<gpu::LobeLight> spread_to_lobes(const OctreeView& octree, const LightDomains& domains,
                                            const LightGroups& groups, std::uint32_t coarser,
                                            const gpu::LightGrid& grid,
                                            std::span<const gpu::LobeLight> lights,
                                            std::span<const gpu::vec4> radiance, bool smooth,
                                            std::vector<std::uint32_t>& lobes);

/// [groups] means over their lobes of what these had in other groups; `before` is null where each
/// lobe was a group of its own.
std::vector<gpu::vec4> regrouped(const LightGroups& groups, const LightGroups* before,
                                 std::span<const gpu::vec4> light);

}  // namespace glowworm

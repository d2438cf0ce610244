#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "shaders/gpu_layout.h"
#include "viewer/gpu/objects.h"
#include "viewer/light/domains.h"
#include "viewer/light/group_light.h"

namespace glowworm {

/// Reflected light of groups of lobes: how it goes along their links and back to the lobes, in
/// compiled code. Octree, domains and links must outlive it.
class GroupField {
  public:
    GroupField(const OctreeView& octree, const LightDomains& domains, const GroupLinks& links);
    void use(const GroupLinks& links) { links_ = &links; }  ///< of the same domains, from now on

    std::uint32_t count() const { return links_->groups.count(); }
    const LightGroups& groups() const { return links_->groups; }

    /// [lobes] radiance that each sends out, W·sr⁻¹·m⁻², by its `direct` irradiance, the `indirect`
    /// one of its group and what it emits; `emitted` is empty where nothing does.
    std::vector<gpu::vec4> radiance(const Buffer& direct, const Buffer& indirect,
                                    std::span<const gpu::vec4> emitted) const;
    /// [groups] irradiance that arrives by that radiance, which it remembers.
    std::vector<gpu::vec4> gather(const Buffer& direct, const Buffer& indirect,
                                  std::span<const gpu::vec4> emitted);
    /// [lobes] what lookups read, of the radiance that was gathered last and the `indirect`
    /// irradiance of groups: read between groups in domains that are shown, elsewhere
    /// each group's own for all of its lobes.
    std::vector<gpu::LobeLight> light(const Buffer& indirect, const gpu::LightGrid& grid,
                                      bool smooth);

  private:
    void find_walls();

    OctreeView octree_;
    const LightDomains* domains_;
    const GroupLinks* links_;
    std::vector<gpu::vec4> radiance_;      // [lobes]
    std::vector<std::uint32_t> walls_;     // [lobes] walls.h, where has_walls_
    std::vector<std::uint8_t> has_walls_;  // [domains]
};

}  // namespace glowworm

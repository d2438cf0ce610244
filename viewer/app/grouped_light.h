#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "octree/progress.h"
#include "octree/scene.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// Light of a cave too large for all lobes to have their own: simulated on groups of them that are
/// small near what is looked at and near lamps, and chosen anew where that has moved. It outlives
/// the light that uses its groups.
class GroupedLight {
  public:
    /// The octree must outlive it.
    GroupedLight(const OctreeView& octree, const LightSettings& settings,
                 std::uint64_t most_groups);
    ~GroupedLight();

    /// Whether the groups were chosen for places half a domain or more from `eye` (m, world), or
    /// not at all, or have but few rays yet.
    bool is_far_from(const Vec3d& eye) const;

    /// Chooses the groups for these places (m, world) and the scene's lamps, and traces what links
    /// are missing. `progress` counts groups.
    void look_from(std::span<const Vec3d> eyes, const Scene& scene, LightField& light,
                   const Progress& progress = {});

    /// The same beside the caller's thread: begins, unless it has begun already. What is looked at
    /// first has a few rays, a preview.
    void begin_to_look_from(const Vec3d& eye, const Scene& scene, const LightField& light);
    bool looks() const { return next_.valid(); }
    double share_done() const { return share_done_; }  ///< 0..1
    /// True where the groups have become others. Rethrows what went wrong.
    bool take(LightField& light);

    const LightGroups& groups() const { return links_.groups; }

  private:
    GroupLinks look(std::span<const Vec3d> eyes, const Scene& scene, std::uint32_t rays,
                    std::shared_ptr<const RayTracer> tracer, const Progress& progress);
    void use(GroupLinks links, LightField& light);

    OctreeView octree_;
    LightSettings settings_;
    std::uint64_t most_groups_;
    std::optional<LightDomains> domains_;  // made when first looked
    GroupLinks links_;
    std::vector<Vec3d> looked_from_;
    std::atomic<double> share_done_ = 0.0;
    std::atomic<bool> cancelled_ = false;
    std::future<GroupLinks> next_;
};

}  // namespace glowworm

#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "octree/progress.h"
#include "octree/scene.h"
#include "viewer/gpu/context.h"
#include "viewer/gpu/objects.h"
#include "viewer/gpu/program.h"
#include "viewer/light/cones.h"
#include "viewer/light/direct_field.h"
#include "viewer/light/group_field.h"
#include "viewer/light/links.h"
#include "viewer/light/settings.h"

namespace glowworm {

/// How an iteration to the fixed point went.
struct Convergence {
    int bounces = 0;
    double residual = 0.0;  ///< mean relative change of a lobe's irradiance by one more bounce
    bool settled = false;
};

/// Light on every lobe of an octree: direct and indirect irradiance and outgoing radiance. The
/// octree must outlive it, and `context` must be current.
class LightField {
  public:
    /// Uploads; no light is reflected yet.
    LightField(const Context& context, const OctreeView& octree, const Scene& scene,
               const LightSettings& settings = {});
    /// With the octree's ground, worked out before.
    LightField(const Context& context, const OctreeView& octree, const Scene& scene,
               const LightSettings& settings, LightGround ground);

    /// Other lights or radiances, which frames and probes see at once; lobes get them by
    /// direct().inject_more() or when light is next reflected. Indirect light stays as it is and is
    /// what the next bounces start from.
    void set_scene(const Scene& scene);

    /// Makes ready what bounces need, once: cones, or links, baked ones where the file has them,
    /// else traced, on the CPU where OpenGL runs on it too. The first bounce calls it where nothing
    /// is ready.
    void prepare(const Progress& progress = {});

    /// The same in steps, each between two pictures: a few rays of every lobe, then as many again.
    /// On the CPU it is one step. False where there was no more to do.
    bool prepare_more();
    /// Light goes along these links from now on, from what it is; what keeps them outlives this.
    void use_links(const LinkRows& rows);

    /// Reflected light is that of groups of lobes from now on, beginning with what it was on those
    /// `before` (null: on every lobe); it goes along the groups' links, on the CPU. Domains and
    /// links outlive their use. Not for cones.
    void use_groups(const LightDomains& domains, const GroupLinks& links,
                    const LightGroups* before = nullptr);

    void forget_indirect();  ///< back to direct light only
    /// `at_rest`: more will not follow at once, so that smoothing (below) is worth its time.
    void iterate(int bounces, bool at_rest = true);
    /// Bounces until the light settles (mean relative change below `tolerance`), with Anderson
    /// acceleration over 3 earlier iterates, safeguarded. What has settled is smoothed: the noise
    /// of each lobe's rays is spread over its neighbours.
    Convergence converge(double tolerance = 1e-4, int max_bounces = 200);

    /// Whether settle() may run on another thread, while frames are drawn.
    bool settles_beside() const;
    /// What converge() does but for show(). Ends early where `cancelled` becomes true.
    Convergence settle(double tolerance, int max_bounces, const std::atomic<bool>& cancelled);
    void show();  ///< what has settled becomes what lookups read

    /// Binds what the includes trace.glsl, direct_light.glsl and light_lookup.glsl read.
    void bind() const;

    /// Binds what cone.glsl reads: the light as it is now, filtered up the octree; that is
    /// returned.
    const ConeGather& show_to_cones() const;
    /// Whether shaders can see all of it; compiled code always does.
    bool fits_shaders() const;

    std::vector<gpu::vec4> read_direct() const;    ///< [lobes] W·m⁻²
    std::vector<gpu::vec4> read_indirect() const;  ///< [lobes] W·m⁻²
    /// Light straight from lamps, which lobes get as it is asked for.
    DirectField& direct() const { return direct_; }
    const GpuOctree& octree() const { return direct_.octree(); }
    const Vec3d& origin() const { return octree_.grid.origin; }  ///< m, of what is uploaded
    const GpuLinks& links() const { return links_; }
    /// [lobes] gpu::LobeLight: what light_lookup.glsl reads.
    const Buffer& lobe_lights() const { return lit_; }
    const LightSettings& settings() const { return settings_; }

  private:
    void prepare_rays(std::uint32_t rays, const Progress& progress);  // at least so many
    void gather();  // from the radiance of the current iterate into gathered_
    std::vector<gpu::LobeLight> light(bool smooth);  // what lookups read, from indirect_
    void publish_from_gpu(bool smooth);
    void blacken();  // what lookups read

    const Context& context_;
    OctreeView octree_;
    LightSettings settings_;
    mutable DirectField direct_;
    std::vector<gpu::vec4> emitted_by_lobes_;  // empty where none emits
    Buffer emitted_;                           // [lobes] vec4
    Buffer indirect_;                          // [lobes] vec4, or [groups]
    mutable Buffer radiance_;                  // [lobes] vec4
    Buffer gathered_;                          // as indirect_
    Buffer lit_;                               // [lobes] LobeLight
    std::vector<gpu::LobeLight> settled_;      // [lobes] what show() shows; empty where it is shown
    mutable std::mutex fields_;                // emitted_ to gathered_, where light settles beside
    Program radiate_, light_gradient_, smooth_light_;
    GpuLinks links_;
    std::optional<GroupField> groups_;
    std::optional<ConeGather> cones_;
    mutable std::optional<ConeGather> mirrored_;  // for show_to_cones, made when first asked for
    std::vector<std::uint32_t> walls_;            // [lobes] walls.h, once light was reflected
};

}  // namespace glowworm

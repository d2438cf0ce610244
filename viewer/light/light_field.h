#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "octree/progress.h"
#include "octree/ray_tracer.h"
#include "octree/scene.h"
#include "viewer/gpu/context.h"
#include "viewer/gpu/objects.h"
#include "viewer/gpu/program.h"
#include "viewer/light/anderson.h"
#include "viewer/light/cones.h"
#include "viewer/light/domains.h"
#include "viewer/light/group_light.h"
#include "viewer/light/links.h"
#include "viewer/light/settings.h"
#include "viewer/light/upload.h"

namespace glowworm {

/// A surface point to measure light at.
struct Probe {
    Vec3d position;  ///< m, world
    Vec3f normal;    ///< unit
};

/// Irradiance, W·m⁻².
struct ProbeResult {
    Vec3f direct;            ///< straight from a light
    Vec3f indirect;          ///< reflected at least once
    bool on_surface = true;  ///< false: no surface that faces its way is near, and indirect is 0
};

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

    /// Other lights or radiances, which frames and probes see at once; lobes get them by
    /// inject_more() or when light is next reflected. Indirect light stays as it is and is what the
    /// next bounces start from.
    void set_scene(const Scene& scene);
    /// A part of the lobes gets the direct light of a lamp, one dispatch. False where all have all.
    bool inject_more() const;
    double share_injected() const;  ///< 0..1

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

    /// Binds what the includes trace.glsl, direct_light.glsl and light_lookup.glsl read.
    void bind() const;

    /// Binds what cone.glsl reads: the light as it is now, filtered up the octree.
    void show_to_cones() const;

    /// The light meter: the same lookup and shadows as a frame's.
    std::vector<ProbeResult> measure(std::span<const Probe> probes) const;

    std::vector<gpu::vec4> read_direct() const;    ///< [lobes] W·m⁻²
    std::vector<gpu::vec4> read_indirect() const;  ///< [lobes] W·m⁻²
    /// The scene's lights as they lie in the buffer that bind() binds.
    std::span<const gpu::Light> lights() const { return lights_; }
    const GpuLinks& links() const { return links_; }
    const GpuOctree& octree() const { return gpu_octree_; }
    /// [groups of lamps][lobes] two words: which lamps a lobe is known to see and not to see
    /// (lamp_looks.glsl), kept while lamps rest. Who shades in compiled code has the lobes look
    /// that it asks. Empty on a GPU, where shadow rays cost less than looks, where no lamps are,
    /// and where looks would take more than kMostLookBytes or settings().memory leaves.
    const Buffer& lamp_looks() const;
    static constexpr std::uint64_t kMostLookBytes = std::uint64_t{1} << 28;
    void look_at_lamps() const;  ///< all lobes, if lamp_looks() are kept
    /// [lobes] gpu::LobeLight: what light_lookup.glsl reads.
    const Buffer& lobe_lights() const { return lit_; }
    const LightSettings& settings() const { return settings_; }

  private:
    void prepare_rays(std::uint32_t rays, const Progress& progress);  // at least so many
    void inject() const;                                              // what is left of it
    bool runs_compiled() const;  // what has a twin in compiled code
    const RayTracer& tracer() const;
    std::vector<ProbeResult> measure_compiled(std::span<const gpu::vec4> places) const;
    void gather();              // from the radiance of the current iterate into gathered_
    void publish(bool smooth);  // what lookups read, from indirect_
    void blacken();             // what lookups read
    std::vector<gpu::vec4> radiance_by_groups() const;  // [lobes]
    void publish_groups(bool smooth);

    const Context& context_;
    OctreeView octree_;
    LightSettings settings_;
    GpuOctree gpu_octree_;
    Buffer grid_;  // LightGrid
    std::vector<gpu::Light> lights_;
    Buffer lights_buffer_;
    Buffer emitted_, direct_;  // [lobes] vec4
    Buffer indirect_;          // [lobes] vec4, or [groups]
    mutable Buffer radiance_;  // [lobes] vec4
    Buffer gathered_;          // as indirect_
    Buffer lit_;               // [lobes] LobeLight
    Program inject_, look_, radiate_, light_gradient_, smooth_light_, probe_direct_,
        probe_indirect_;
    GpuLinks links_;
    const LightDomains* domains_ = nullptr;
    const GroupLinks* groups_ = nullptr;
    std::vector<gpu::vec4> emitted_by_lobes_;   // empty where none emits
    std::vector<gpu::vec4> radiance_by_lobes_;  // what groups_ gathered last
    std::optional<ConeGather> cones_;
    mutable std::optional<ConeGather> mirrored_;  // for show_to_cones, made when first asked for
    std::vector<std::uint32_t> walls_;            // [lobes] walls.h, once light was reflected
    mutable std::unique_ptr<RayTracer> tracer_;   // made when first asked for
    mutable std::uint32_t injected_lights_ = 0;   // whole ones
    mutable std::size_t injected_lobes_ = 0;      // of the next light
    mutable std::optional<Buffer> lamp_looks_;    // made when first asked for
    mutable bool all_looked_ = false;             // lamp_looks_ is complete
};

}  // namespace glowworm

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "octree/octree_file.h"
#include "octree/ray_tracer.h"
#include "viewer/gpu/context.h"
#include "viewer/gpu/objects.h"
#include "viewer/gpu/program.h"
#include "viewer/light/settings.h"
#include "viewer/light/upload.h"

namespace glowworm {

/// Light straight from lamps on every lobe of an octree, and which lamps each lobe sees. The octree
/// must outlive it, and `context` must be current.
class DirectField {
  public:
    /// Uploads the octree; there are no lamps yet.
    DirectField(const Context& context, const OctreeView& octree, const LightSettings& settings,
                LightGround ground);

    /// Other lamps; lobes get their light by inject_more().
    void set_lights(std::vector<gpu::Light> lights);
    /// The scene's lights as they lie in the buffer that bind() binds.
    std::span<const gpu::Light> lights() const { return lights_; }
    /// A part of the lobes gets the light of a lamp, one dispatch. False where all have all.
    bool inject_more();
    void inject();                  ///< what is left of it
    double share_injected() const;  ///< 0..1
    /// [lobes] W·m⁻²
    const Buffer& irradiance() const { return irradiance_; }

    /// [groups of lamps][lobes] two words: which lamps a lobe is known to see and not to see
    /// (lamp_looks.glsl), kept while lamps rest. Who shades in compiled code has the lobes look
    /// that it asks. Empty on a GPU, where shadow rays cost less than looks, where no lamps are,
    /// and where looks would take more than kMostLookBytes or the settings' memory leaves.
    const Buffer& lamp_looks();
    static constexpr std::uint64_t kMostLookBytes = std::uint64_t{1} << 28;
    void look_at_lamps();  ///< all lobes, if lamp_looks() are kept

    /// Binds what the includes trace.glsl and direct_light.glsl read.
    void bind() const;

    const GpuOctree& octree() const { return gpu_octree_; }
    bool runs_compiled() const;  ///< whether what has a twin in compiled code is done by that
    const std::shared_ptr<const RayTracer>& tracer();  ///< of the octree, its patches closed

  private:
    const Context& context_;
    OctreeView octree_;
    LightSettings settings_;
    GpuOctree gpu_octree_;
    Buffer grid_;  // LightGrid
    std::vector<gpu::Light> lights_;
    Buffer lights_buffer_;
    Buffer irradiance_;
    std::optional<Program> inject_, look_;  // made when first asked for, as are the next two
    std::shared_ptr<const RayTracer> tracer_;
    std::optional<Buffer> lamp_looks_;
    bool all_looked_ = false;            // lamp_looks_ is complete
    std::uint32_t injected_lights_ = 0;  // whole ones
    std::size_t injected_lobes_ = 0;     // of the next light
};

}  // namespace glowworm

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "octree/octree_file.h"
#include "octree/scene.h"
#include "viewer/app/link_worker.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// Light that goes on propagating while a window draws: links are traced beside its thread where
/// OpenGL runs on the CPU, and each frame adds a few bounces until the light settles.
class LiveLight {
  public:
    LiveLight(const Context& context, const OctreeView& octree, const Scene& scene,
              const LightSettings& settings, std::optional<int> bounces);

    void set_scene(const Scene& scene);
    /// A few bounces, or the links when they have arrived. True where the light has changed.
    bool advance();

    const LightField& field() const { return *field_; }
    bool settled() const { return settled_; }
    /// Whether advance() did what does not show yet, and there is more of it to do.
    bool injecting() const { return injecting_; }
    std::string status() const;  ///< for people
    /// Mean relative change of the light by each step since the lamps changed.
    const std::vector<float>& residuals() const { return residuals_; }

  private:
    bool inject_for_a_while();

    const Context& context_;
    OctreeView octree_;
    Scene scene_;
    LightSettings settings_;
    std::optional<int> most_bounces_;
    std::unique_ptr<LinkWorker> worker_;
    std::vector<std::uint32_t> links_;  // what octree_.links shows once the worker is done
    std::unique_ptr<LightField> field_;
    std::vector<float> residuals_;
    bool settled_ = false;
    bool injecting_ = false;
    int bounces_ = 0;  // since the lights last changed
};

}  // namespace glowworm

#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "octree/octree_file.h"
#include "octree/scene.h"
#include "viewer/app/grouped_light.h"
#include "viewer/app/link_worker.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// Light that goes on propagating while a window draws. The first picture shows direct light; each
/// frame adds a few bounces along the first rays of every lobe, a preview, until the light settles,
/// and goes on from there when more rays are traced. Where OpenGL runs on the CPU they are traced,
/// and light goes along them, beside the window's thread, else a step between two frames.
class LiveLight {
  public:
    /// `most_groups`: of lobes that light is simulated on (grouped_light.h); 0: each for itself.
    LiveLight(const Context& context, const OctreeView& octree, const Scene& scene,
              const LightSettings& settings, std::optional<int> bounces,
              std::uint64_t most_groups = 0);
    /// With the octree's ground, worked out before.
    LiveLight(const Context& context, const OctreeView& octree, const Scene& scene,
              const LightSettings& settings, std::optional<int> bounces, std::uint64_t most_groups,
              LightGround ground);

    ~LiveLight();
    LiveLight(const LiveLight&) = delete;
    LiveLight& operator=(const LiveLight&) = delete;

    void set_scene(const Scene& scene);
    /// Where the camera is (m, world): grouped light becomes finer there, by and by.
    void look_from(const Vec3d& eye);
    /// A few bounces, along more rays where they have arrived. True where the light has changed.
    bool advance();

    const LightField& field() const { return *field_; }
    bool settled() const { return settled_ && all_traced_; }
    /// Whether advance() did what does not show yet, and there is more of it to do.
    bool injecting() const { return injecting_; }
    std::string status() const;  ///< for people
    /// Mean relative change of the light by each step since the lamps changed.
    const std::vector<float>& residuals() const { return residuals_; }

  private:
    bool inject_for_a_while();
    void stop_settling();
    void count(const Convergence& result);
    void begin_bounces();
    bool take_rays();

    Scene scene_;
    LightSettings settings_;
    std::optional<int> most_bounces_;
    std::unique_ptr<LinkWorker> worker_;     // outlives the field that uses its links
    std::unique_ptr<GroupedLight> grouped_;  // so does this
    std::unique_ptr<LightField> field_;
    std::vector<float> residuals_;
    bool all_traced_ = false;  // or whatever else light goes along
    bool settled_ = false;
    bool injecting_ = false;
    int bounces_ = 0;  // since the lights or the rays last changed
    std::atomic<bool> cancelled_ = false;
    std::future<Convergence> settling_;  // beside the window's thread
};

}  // namespace glowworm

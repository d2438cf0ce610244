#include "viewer/app/live_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace glowworm {
namespace {

constexpr int kBouncesAtOnce = 4;    // between two frames
constexpr int kBouncesEnough = 200;  // where the light does not settle by itself
constexpr double kTolerance = 1e-3;  // relative change that nobody sees any more
constexpr auto kInjectTime = std::chrono::milliseconds(50);  // between two frames

}  // namespace

LiveLight::LiveLight(const Context& context, const OctreeView& octree, const Scene& scene,
                     const LightSettings& settings, std::optional<int> bounces)
    : context_(context),
      octree_(octree),
      scene_(scene),
      settings_(settings),
      most_bounces_(bounces) {
    field_ = std::make_unique<LightField>(context, octree_, scene, settings);
    const bool baked = octree.links_per_lobe >= settings.links;
    if (bounces == 0) {
        settled_ = true;
    } else if (settings.gather == Gather::kLinks && context.device().software && !baked) {
        worker_ = std::make_unique<LinkWorker>(
            octree_, LinkSettings{.rays = settings.links, .trace = settings.trace});
    }
}

void LiveLight::set_scene(const Scene& scene) {
    scene_ = scene;
    field_->set_scene(scene);
    settled_ = most_bounces_ == 0;
    bounces_ = 0;
    residuals_.clear();
    if (most_bounces_) field_->forget_indirect();  // so many bounces of these lights, not of others
}

/// True where direct light has not reached all lobes by the end of that while.
bool LiveLight::inject_for_a_while() {
    const auto begun = std::chrono::steady_clock::now();
    while (field_->inject_more()) {
        glFinish();
        if (std::chrono::steady_clock::now() - begun > kInjectTime) return true;
    }
    return false;
}

bool LiveLight::advance() {
    if (settled_) return false;
    if (worker_) {
        auto links = worker_->take();
        if (!links) return false;
        links_ = std::move(*links);
        octree_.links = links_;
        octree_.links_per_lobe = settings_.links;
        field_ = std::make_unique<LightField>(context_, octree_, scene_, settings_);
        worker_.reset();
    }
    injecting_ = inject_for_a_while();
    if (injecting_) return false;
    const int most = most_bounces_.value_or(kBouncesEnough);
    const int now = std::min(kBouncesAtOnce, most - bounces_);
    if (most_bounces_) {
        bounces_ += now;
        field_->iterate(now, bounces_ >= most);
    } else {
        const Convergence result = field_->converge(kTolerance, now);
        bounces_ += std::max(result.bounces, 1);
        settled_ = result.settled;
        residuals_.push_back(static_cast<float>(result.residual));
    }
    settled_ = settled_ || bounces_ >= most;
    return true;
}

std::string LiveLight::status() const {
    if (worker_) return fmt::format("tracing links, {:.0f} %", worker_->share_done() * 100.0);
    if (most_bounces_ == 0) return "direct only";
    if (injecting_) {
        return fmt::format("direct light reaches the walls, {:.0f} %",
                           field_->share_injected() * 100.0);
    }
    return fmt::format("{} {} bounces", settled_ ? "settled after" : "propagating,", bounces_);
}

}  // namespace glowworm

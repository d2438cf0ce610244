#include "viewer/app/live_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace glowworm {
namespace {

constexpr int kBouncesAtOnce = 4;    // between two frames
constexpr int kBouncesEnough = 200;  // where the light does not settle by itself
constexpr double kTolerance = 1e-3;  // relative change that nobody sees any more
constexpr auto kInjectTime = std::chrono::milliseconds(50);  // between two frames

}  // namespace

LiveLight::LiveLight(const Context& context, const OctreeView& octree, const Scene& scene,
                     const LightSettings& settings, std::optional<int> bounces,
                     std::uint64_t most_groups)
    : LiveLight(context, octree, scene, settings, bounces, most_groups,
                make_light_ground(octree, settings.trace, false)) {}

LiveLight::LiveLight(const Context& context, const OctreeView& octree, const Scene& scene,
                     const LightSettings& settings, std::optional<int> bounces,
                     std::uint64_t most_groups, LightGround ground)
    : scene_(scene), settings_(settings), most_bounces_(bounces) {
    field_ = std::make_unique<LightField>(context, octree, scene, settings, std::move(ground));
    const bool links = settings.gather == Gather::kLinks && !settings.faithful;
    const bool baked = octree.links_per_lobe >= settings.links;
    if (bounces == 0) {
        settled_ = all_traced_ = true;
    } else if (links && most_groups > 0) {
        grouped_ = std::make_unique<GroupedLight>(octree, settings, most_groups);
    } else if (links && context.device().software && !baked) {
        worker_ = std::make_unique<LinkWorker>(
            octree, LinkSettings{.rays = settings.links, .trace = settings.trace},
            field_->direct().tracer());
    }
}

LiveLight::~LiveLight() {
    stop_settling();
}

/// What has not settled yet is begun anew, from as far as it came.
void LiveLight::stop_settling() {
    if (!settling_.valid()) return;
    cancelled_ = true;
    settling_.wait();
    settling_ = {};
    cancelled_ = false;
}

void LiveLight::set_scene(const Scene& scene) {
    stop_settling();
    scene_ = scene;
    field_->set_scene(scene);
    settled_ = most_bounces_ == 0;
    residuals_.clear();
    begin_bounces();
}

void LiveLight::begin_bounces() {
    bounces_ = 0;
    if (most_bounces_) field_->forget_indirect();  // so many bounces of this light, not of other
}

void LiveLight::look_from(const Vec3d& eye) {
    if (grouped_ && !grouped_->looks() && grouped_->is_far_from(eye))
        grouped_->begin_to_look_from(eye, scene_, *field_);
}

/// Whether light now goes along more rays than before.
bool LiveLight::take_rays() {
    const std::uint32_t before = field_->links().rays();
    if (grouped_) {
        const bool others = grouped_->take(*field_);
        all_traced_ = !grouped_->looks() && field_->links().rays() == settings_.links;
        return others;
    }
    if (worker_) {
        const std::uint32_t ready = worker_->rays_ready();
        if (ready > before) field_->use_links(worker_->first_rays(ready));
        all_traced_ = ready == settings_.links;
    } else if (settled_ || before == 0) {  // what is there is shown settled before more is traced
        const bool more = field_->prepare_more();
        all_traced_ = !more || field_->links().rays() == settings_.links;
    }
    return field_->links().rays() > before;
}

/// True where direct light has not reached all lobes by the end of that while.
bool LiveLight::inject_for_a_while() {
    const auto begun = std::chrono::steady_clock::now();
    while (field_->direct().inject_more()) {
        glFinish();
        if (std::chrono::steady_clock::now() - begun > kInjectTime) return true;
    }
    return false;
}

void LiveLight::count(const Convergence& result) {
    bounces_ += std::max(result.bounces, 1);
    settled_ = result.settled || bounces_ >= kBouncesEnough;
    residuals_.push_back(static_cast<float>(result.residual));
}

bool LiveLight::advance() {
    if (settling_.valid()) {
        if (settling_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
        count(settling_.get());
        field_->show();
        return true;
    }
    if (grouped_ && grouped_->looks()) all_traced_ = false;
    if (settled()) return false;
    injecting_ = inject_for_a_while();
    if (injecting_) return false;
    if (!all_traced_ && take_rays()) {
        settled_ = false;
        begin_bounces();
    }
    const bool nothing_to_follow = (worker_ || grouped_) && field_->links().rays() == 0;
    if (settled_ || nothing_to_follow) return false;
    if (most_bounces_) {
        bounces_ = *most_bounces_;
        field_->iterate(bounces_);
        settled_ = true;
        return true;
    }
    const int now = std::min(kBouncesAtOnce, kBouncesEnough - bounces_);
    if (field_->settles_beside()) {
        settling_ = std::async(std::launch::async,
                               [this, now] { return field_->settle(kTolerance, now, cancelled_); });
        return false;
    }
    count(field_->converge(kTolerance, now));
    return true;
}

std::string LiveLight::status() const {
    if (most_bounces_ == 0) return "direct only";
    const std::uint32_t rays = field_->links().rays();
    if (injecting_) {
        return fmt::format("{}direct light reaches the walls, {:.0f} %",
                           rays == 0 ? "direct only; " : "",
                           field_->direct().share_injected() * 100.0);
    }
    const double traced = grouped_  ? grouped_->share_done()
                          : worker_ ? worker_->share_done()
                                    : double(rays) / double(settings_.links);
    if ((worker_ || grouped_) && rays == 0)
        return fmt::format("direct only; tracing links, {:.0f} %", traced * 100.0);
    const std::string light =
        fmt::format("{} {} bounces", settled_ ? "settled after" : "propagating,", bounces_);
    if (all_traced_ || rays == 0) return light;
    if (grouped_)
        return fmt::format("{}; tracing links where you went, {:.0f} %", light, traced * 100.0);
    return fmt::format("a preview by {} of {} rays a lobe, {}; tracing links, {:.0f} %", rays,
                       settings_.links, light, traced * 100.0);
}

}  // namespace glowworm

#include "viewer/app/grouped_light.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "octree/error.h"

namespace glowworm {
namespace {

constexpr float kLampRemote = 2.0f;      // a lamp matters less than what is looked at
constexpr std::size_t kMostEyes = 4096;  // of many probes, some spread over them

/// Light's own tracer, where it has one.
std::shared_ptr<const RayTracer> tracer_of(const LightField& light) {
    return light.direct().runs_compiled() ? light.direct().tracer() : nullptr;
}

}  // namespace

GroupedLight::GroupedLight(const OctreeView& octree, const LightSettings& settings,
                           std::uint64_t most_groups)
    : octree_(octree), settings_(settings), most_groups_(most_groups) {}

GroupedLight::~GroupedLight() {
    cancelled_ = true;
    if (next_.valid()) next_.wait();
}

bool GroupedLight::is_far_from(const Vec3d& eye) const {
    if (links_.rays != settings_.links) return true;
    return std::ranges::none_of(looked_from_, [&](const Vec3d& from) {
        return length(from - eye) < 0.5 * static_cast<double>(LightDomains::edge(octree_));
    });
}

GroupLinks GroupedLight::look(std::span<const Vec3d> eyes, const Scene& scene, std::uint32_t rays,
                              std::shared_ptr<const RayTracer> tracer, const Progress& progress) {
    if (!domains_) domains_.emplace(octree_);
    std::vector<Focus> foci;
    const auto add = [&](const Vec3d& place, float remote) {
        foci.push_back({vec3_cast<float>(place - octree_.grid.origin), remote});
    };
    const std::size_t step = eyes.size() / kMostEyes + 1;
    for (std::size_t i = 0; i < eyes.size(); i += step)
        add(eyes[i], 1.0f);
    for (const PointLight& lamp : scene.point_lights)
        add(lamp.position, kLampRemote);
    for (const SpotLight& lamp : scene.spot_lights)
        add(lamp.position, kLampRemote);
    for (const AreaLight& lamp : scene.area_lights)
        add((lamp.corners[0] + lamp.corners[2]) * 0.5, kLampRemote);
    auto coarser = domains_->choose(foci, most_groups_);
    auto shown = domains_->shown_to(foci);
    const bool same = coarser == links_.groups.coarser && shown == links_.groups.shown;
    if (same && links_.rays == rays) return {};
    const GroupLinks* before = links_.groups.coarser.empty() ? nullptr : &links_;
    LightSettings settings = settings_;
    settings.links = rays;
    return link_groups(octree_, domains_->group(std::move(coarser), std::move(shown)), settings,
                       before, progress, std::move(tracer));
}

void GroupedLight::use(GroupLinks links, LightField& light) {
    GroupLinks before = std::exchange(links_, std::move(links));
    light.use_groups(*domains_, links_, before.groups.coarser.empty() ? nullptr : &before.groups);
}

void GroupedLight::look_from(std::span<const Vec3d> eyes, const Scene& scene, LightField& light,
                             const Progress& progress) {
    GroupLinks links = look(eyes, scene, settings_.links, tracer_of(light), progress);
    looked_from_.assign(eyes.begin(), eyes.end());
    if (!links.groups.coarser.empty()) use(std::move(links), light);
}

void GroupedLight::begin_to_look_from(const Vec3d& eye, const Scene& scene,
                                      const LightField& light) {
    if (next_.valid()) return;
    looked_from_ = {eye};
    share_done_ = 0.0;
    const std::uint32_t rays =
        links_.rays == 0 ? std::min(kPreviewRays, settings_.links) : settings_.links;
    next_ = std::async(std::launch::async, [this, eye, scene, rays, tracer = tracer_of(light)] {
        const auto progress = [this](std::uint64_t done, std::uint64_t total) {
            if (cancelled_) throw Error(ExitCode::kCancelled, "cancelled");
            share_done_ = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 1.0;
        };
        return look(std::span(&eye, 1), scene, rays, tracer, progress);
    });
}

bool GroupedLight::take(LightField& light) {
    if (!next_.valid() || next_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return false;
    GroupLinks links = next_.get();
    if (links.groups.coarser.empty()) return false;
    use(std::move(links), light);
    return true;
}

}  // namespace glowworm

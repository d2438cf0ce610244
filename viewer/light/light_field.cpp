#include "viewer/light/light_field.h"

#include <algorithm>
#include <utility>

#include "viewer/light/anderson.h"
#include "viewer/light/lookup.h"
#include "viewer/light/smoothing.h"
#include "viewer/light/walls.h"

namespace glowworm {

namespace {

constexpr std::size_t kGroup = 64;
constexpr std::size_t kLobesAtOnce = 1 << 16;  // a dispatch stays short enough for a display's GPU
constexpr int kLeastBounces = 2;

std::size_t field_bytes(const OctreeView& octree) {
    return octree.lobes.size() * sizeof(gpu::vec4);
}

bool shines(const gpu::vec4& radiance) {
    return radiance.x != 0.0f || radiance.y != 0.0f || radiance.z != 0.0f;
}

}  // namespace

LightField::LightField(const Context& context, const OctreeView& octree, const Scene& scene,
                       const LightSettings& settings)
    : LightField(context, octree, scene, settings,
                 make_light_ground(octree, settings.trace, false)) {}

LightField::LightField(const Context& context, const OctreeView& octree, const Scene& scene,
                       const LightSettings& settings, LightGround ground)
    : context_(context),
      octree_(octree),
      settings_(settings),
      direct_(context, octree, settings, std::move(ground)),
      indirect_("indirect irradiance", field_bytes(octree)),
      radiance_("outgoing radiance", field_bytes(octree)),
      gathered_("gathered irradiance", field_bytes(octree)),
      lit_("light of lobes", octree.lobes.size() * sizeof(gpu::LobeLight)),
      radiate_({"radiate.comp"}),
      light_gradient_({"light_gradient.comp"}),
      smooth_light_({"smooth_light.comp"}) {
    lit_.clear();
    set_scene(scene);
}

void LightField::set_scene(const Scene& scene) {
    direct_.set_lights(lights_for_gpu(scene, octree_, settings_.faithful));
    emitted_by_lobes_ = emitted_radiance(scene, octree_, settings_.faithful);
    if (!groups_)
        emitted_ = Buffer::of("emitted radiance", std::span<const gpu::vec4>(emitted_by_lobes_));
    if (std::ranges::none_of(emitted_by_lobes_, shines)) emitted_by_lobes_ = {};
}

void LightField::bind() const {
    direct_.bind();
    indirect_.bind_storage(BINDING_INDIRECT);
    radiance_.bind_storage(BINDING_RADIANCE);
    lit_.bind_storage(BINDING_LIGHT);
}

const ConeGather& LightField::show_to_cones() const {
    const std::lock_guard lock(fields_);
    direct_.inject();
    if (!mirrored_) mirrored_.emplace(octree_, LightSettings{});
    if (groups_) {
        const auto radiance = groups_->radiance(direct_.irradiance(), indirect_, emitted_by_lobes_);
        radiance_ = Buffer::of("outgoing radiance", std::span<const gpu::vec4>(radiance));
    }
    bind();
    emitted_.bind_storage(BINDING_SCRATCH_A);
    if (!groups_) radiate_.dispatch(octree_.lobes.size(), kGroup);
    mirrored_->filter();
    return *mirrored_;
}

void LightField::prepare(const Progress& progress) {
    if (octree_.lobes.empty()) return;
    prepare_rays(kMostLinks, progress);
    bind();
    while (links_.trace_more(progress)) {
    }
}

bool LightField::prepare_more() {
    if (octree_.lobes.empty()) return false;
    if (links_.empty() && !cones_) {
        prepare_rays(kPreviewRays, {});
        return true;
    }
    bind();
    return links_.trace_more();
}

void LightField::prepare_rays(std::uint32_t rays, const Progress& progress) {
    if (!links_.empty() || cones_) return;
    bind();
    if (settings_.gather == Gather::kCones || settings_.faithful) {
        cones_.emplace(octree_, settings_);
        return;
    }
    links_ = GpuLinks(context_, octree_, settings_, progress, rays,
                      direct_.runs_compiled() ? direct_.tracer() : nullptr);
}

void LightField::use_links(const LinkRows& rows) {
    links_ = GpuLinks(rows);
}

void LightField::use_groups(const LightDomains& domains, const GroupLinks& links,
                            const LightGroups* before) {
    const std::size_t had = before != nullptr ? before->count() : octree_.lobes.size();
    const auto light = regrouped(links.groups, before, indirect_.read<gpu::vec4>(had));
    indirect_ = Buffer::of("indirect irradiance", std::span<const gpu::vec4>(light));
    gathered_ = Buffer("gathered irradiance", light.size() * sizeof(gpu::vec4));
    radiance_ = {};
    emitted_ = {};
    if (groups_ && before != nullptr) {
        groups_->use(links);
    } else {
        groups_.emplace(octree_, domains, links);
    }
    links_ = GpuLinks(links.rows());
}

void LightField::forget_indirect() {
    indirect_.clear();
    blacken();
}

bool LightField::fits_shaders() const {
    return glowworm::fits_shaders(context_, octree_);
}

void LightField::blacken() {
    if (walls_.empty()) {
        lit_.clear();
        return;
    }
    std::vector<gpu::LobeLight> black(octree_.lobes.size());
    for (std::size_t i = 0; i < walls_.size(); ++i)
        black[i].irradiance.w = static_cast<float>(walls_[i]);
    lit_.write(black);
}

void LightField::gather() {
    direct_.inject();
    if (groups_) {
        gathered_.write(groups_->gather(direct_.irradiance(), indirect_, emitted_by_lobes_));
        return;
    }
    if (settles_beside()) {
        const std::span<gpu::vec4> radiance = radiance_.map<gpu::vec4>();
        radiate(direct_.octree().lobes.map<const Lobe>(), emitted_.map<const gpu::vec4>(),
                direct_.irradiance().map<const gpu::vec4>(), {}, indirect_.map<const gpu::vec4>(),
                radiance);
        bounce_along(*links_.on_cpu(), radiance, gathered_.map<gpu::vec4>());
        return;
    }
    bind();
    emitted_.bind_storage(BINDING_SCRATCH_A);
    radiate_.dispatch(octree_.lobes.size(), kGroup);
    gathered_.bind_storage(BINDING_SCRATCH_B);
    if (cones_) {
        cones_->filter();
        cones_->gather();
    } else {
        links_.gather(radiance_, gathered_);
    }
}

bool LightField::settles_beside() const {
    return direct_.runs_compiled() && links_.on_cpu() != nullptr;
}

/// Empty where the GPU has written it.
std::vector<gpu::LobeLight> LightField::light(bool smooth) {
    if (groups_) return groups_->light(indirect_, octree().grid, smooth);
    const bool first = walls_.empty();
    if (first) walls_ = walls_beside(octree_);
    const LinkRows* rows = links_.on_cpu();
    if (cones_ || rows == nullptr) {
        if (first) blacken();
        publish_from_gpu(smooth);
        return {};
    }
    const std::size_t lobes = octree_.lobes.size();
    auto lights = light_gradients(*rows, octree_.lobes, radiance_.read<gpu::vec4>(lobes),
                                  indirect_.read<gpu::vec4>(lobes), walls_);
    if (!smooth) return lights;
    const auto closed = octree().lobes.read<Lobe>(lobes);
    return smoothed({octree_.nodes, closed, lights, octree().grid});
}

void LightField::show() {
    if (!settled_.empty()) lit_.write(settled_);
    settled_ = {};
}

void LightField::publish_from_gpu(bool smooth) {
    bind();
    lit_.bind_storage(BINDING_SCRATCH_B);
    const std::size_t lobes = octree_.lobes.size();
    if (cones_) {  // no rays, no noise
        set_uniform(light_gradient_, 0, 0u);
        set_uniform(light_gradient_, 1, static_cast<std::uint32_t>(lobes));
        set_uniform(light_gradient_, 2, 0u);
        light_gradient_.dispatch(lobes, kGroup);
        return;
    }
    links_.over_blocks(light_gradient_);
    bind();
    if (!smooth) return;
    Buffer smoothed("light of lobes", lobes * sizeof(gpu::LobeLight));
    smoothed.bind_storage(BINDING_SCRATCH_B);
    for (std::size_t first = 0; first < lobes; first += kLobesAtOnce) {
        const std::size_t last = std::min(lobes, first + kLobesAtOnce);
        set_uniform(smooth_light_, 0, static_cast<std::uint32_t>(first));
        set_uniform(smooth_light_, 1, static_cast<std::uint32_t>(last));
        smooth_light_.dispatch(last - first, kGroup);
    }
    lit_ = std::move(smoothed);
    bind();
}

void LightField::iterate(int bounces, bool at_rest) {
    if (bounces <= 0 || octree_.lobes.empty()) return;
    prepare_rays(kMostLinks, {});
    for (int i = 0; i < bounces; ++i) {
        gather();
        std::swap(indirect_, gathered_);
    }
    settled_ = light(at_rest);
    show();
}

Convergence LightField::converge(double tolerance, int max_bounces) {
    const std::atomic<bool> cancelled = false;
    const Convergence result = settle(tolerance, max_bounces, cancelled);
    show();
    return result;
}

Convergence LightField::settle(double tolerance, int max_bounces,
                               const std::atomic<bool>& cancelled) {
    Convergence result;
    if (octree_.lobes.empty()) return {.settled = true};
    prepare_rays(kMostLinks, {});
    Anderson anderson(groups_ ? groups_->count() : octree_.lobes.size(), direct_.runs_compiled());
    while (result.bounces < max_bounces && !result.settled) {
        if (cancelled) return result;
        const std::lock_guard lock(fields_);
        gather();
        result.residual = anderson.step(indirect_, gathered_).relative;
        ++result.bounces;
        result.settled = result.bounces >= kLeastBounces && result.residual < tolerance;
    }
    if (!cancelled) settled_ = light(result.settled);
    return result;
}

std::vector<gpu::vec4> LightField::read_direct() const {
    direct_.inject();
    return direct_.irradiance().read<gpu::vec4>(octree_.lobes.size());
}

std::vector<gpu::vec4> LightField::read_indirect() const {
    if (!groups_) return indirect_.read<gpu::vec4>(octree_.lobes.size());
    const auto of_groups = indirect_.read<gpu::vec4>(groups_->count());
    std::vector<gpu::vec4> of_lobes;
    for (const std::uint32_t group : groups_->groups().group_of)
        of_lobes.push_back(of_groups[group]);
    return of_lobes;
}

}  // namespace glowworm

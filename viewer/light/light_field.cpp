#include "viewer/light/light_field.h"

#include <algorithm>

#include "viewer/gpu/vec4.h"
#include "viewer/light/direct.h"
#include "viewer/light/lookup.h"
#include "viewer/light/walls.h"

namespace glowworm {

namespace {

constexpr std::size_t kGroup = 64;
constexpr std::size_t kLobesAtOnce = 1 << 16;  // a dispatch stays short enough for a display's GPU
constexpr int kLeastBounces = 2;
constexpr double kFarthest = 1e7;  // m

/// Of each probe, its direct and its indirect irradiance.
std::vector<ProbeResult> probe_results(std::span<const gpu::vec4> measured) {
    std::vector<ProbeResult> results;
    for (std::size_t i = 0; i < measured.size(); i += 2) {
        results.push_back(
            {to_vec3(measured[i]), to_vec3(measured[i + 1]), measured[i + 1].w > 0.0f});
    }
    return results;
}

std::size_t field_bytes(const OctreeView& octree) {
    return octree.lobes.size() * sizeof(gpu::vec4);
}

/// Whether two lights cast the same shadows.
bool same_place(const gpu::Light& a, const gpu::Light& b) {
    return a.kind == b.kind && a.tag == b.tag && to_vec3(a.position) == to_vec3(b.position) &&
           to_vec3(a.axis) == to_vec3(b.axis) && to_vec3(a.edge_u) == to_vec3(b.edge_u) &&
           to_vec3(a.edge_v) == to_vec3(b.edge_v);
}

bool shines(const gpu::vec4& radiance) {
    return radiance.x != 0.0f || radiance.y != 0.0f || radiance.z != 0.0f;
}

}  // namespace

LightField::LightField(const Context& context, const OctreeView& octree, const Scene& scene,
                       const LightSettings& settings)
    : context_(context),
      octree_(octree),
      settings_(settings),
      gpu_octree_(upload(context, octree, settings)),
      grid_("light grid", sizeof(gpu::LightGrid)),
      direct_("direct irradiance", field_bytes(octree)),
      indirect_("indirect irradiance", field_bytes(octree)),
      radiance_("outgoing radiance", field_bytes(octree)),
      gathered_("gathered irradiance", field_bytes(octree)),
      lit_("light of lobes", octree.lobes.size() * sizeof(gpu::LobeLight)),
      inject_({"inject.comp"}),
      look_({"lamp_looks.comp"}),
      radiate_({"radiate.comp"}),
      light_gradient_({"light_gradient.comp"}),
      smooth_light_({"smooth_light.comp"}),
      probe_direct_({"probe_direct.comp"}),
      probe_indirect_({"probe_indirect.comp"}) {
    lit_.clear();
    set_scene(scene);
}

void LightField::set_scene(const Scene& scene) {
    std::vector<gpu::Light> lights = lights_for_gpu(scene, octree_, settings_.faithful);
    if (!std::ranges::equal(lights, lights_, same_place)) lamp_looks_.reset();
    lights_ = std::move(lights);
    lights_buffer_ = Buffer::of("lights", std::span<const gpu::Light>(lights_));
    emitted_by_lobes_ = emitted_radiance(scene, octree_, settings_.faithful);
    if (groups_ == nullptr)
        emitted_ = Buffer::of("emitted radiance", std::span<const gpu::vec4>(emitted_by_lobes_));
    if (std::ranges::none_of(emitted_by_lobes_, shines)) emitted_by_lobes_ = {};
    gpu_octree_.grid.light_count = static_cast<std::uint32_t>(lights_.size());
    grid_.write(std::span<const gpu::LightGrid>(&gpu_octree_.grid, 1));
    direct_.clear();
    injected_lights_ = 0;
    injected_lobes_ = 0;
}

bool LightField::inject_more() const {
    const std::size_t lobes = octree_.lobes.size();
    if (lobes == 0 || injected_lights_ == gpu_octree_.grid.light_count) return false;
    const std::size_t first = injected_lobes_, last = std::min(lobes, first + kLobesAtOnce);
    if (runs_compiled()) {
        const RayTracer& rays = tracer();
        const auto closed = gpu_octree_.lobes.map<const Lobe>();
        const auto direct = direct_.map<gpu::vec4>();
        add_direct_light({rays, closed, lights_, gpu_octree_.grid}, injected_lights_, first,
                         std::span<gpu::vec4>(direct).subspan(first, last - first));
    } else {
        bind();
        set_uniform(inject_, 0, static_cast<std::uint32_t>(first));
        set_uniform(inject_, 1, static_cast<std::uint32_t>(last));
        set_uniform(inject_, 2, injected_lights_);
        inject_.dispatch(last - first, kGroup);
    }
    injected_lobes_ = last;
    if (last == lobes) {
        injected_lobes_ = 0;
        ++injected_lights_;
    }
    return true;
}

bool LightField::runs_compiled() const {
    return context_.device().software && settings_.run_on != RunOn::kGpu;
}

const RayTracer& LightField::tracer() const {
    if (!tracer_) {
        const auto closed = gpu_octree_.lobes.map<const Lobe>();
        OctreeView octree = octree_;
        octree.lobes = closed;
        tracer_ = std::make_unique<RayTracer>(octree, settings_.trace);
    }
    return *tracer_;
}

double LightField::share_injected() const {
    const auto lobes = static_cast<double>(octree_.lobes.size());
    const double lights = gpu_octree_.grid.light_count;
    if (lobes == 0.0 || lights == 0.0) return 1.0;
    return (injected_lights_ + static_cast<double>(injected_lobes_) / lobes) / lights;
}

void LightField::inject() const {
    while (inject_more()) {
    }
}

void LightField::bind() const {
    grid_.bind_uniform(BINDING_LIGHT_GRID);
    gpu_octree_.nodes.bind_storage(BINDING_NODES);
    gpu_octree_.lobes.bind_storage(BINDING_LOBES);
    direct_.bind_storage(BINDING_DIRECT);
    indirect_.bind_storage(BINDING_INDIRECT);
    radiance_.bind_storage(BINDING_RADIANCE);
    lights_buffer_.bind_storage(BINDING_LIGHTS);
    lit_.bind_storage(BINDING_LIGHT);
}

const Buffer& LightField::lamp_looks() const {
    if (lamp_looks_) return *lamp_looks_;
    const std::uint64_t lobes = octree_.lobes.size();
    const std::uint64_t groups = (lights_.size() + LAMPS_IN_GROUP - 1) / LAMPS_IN_GROUP;
    const std::uint64_t bytes = groups * lobes * 2 * sizeof(gpu::uint);
    std::uint64_t most = context_.device().software ? kMostLookBytes : 0;
    if (settings_.memory > 0) {
        const std::uint64_t others = light_bytes(octree_.nodes.size(), lobes, settings_);
        most = std::min(most, settings_.memory - std::min(settings_.memory, others));
    }
    lamp_looks_.emplace("looks at lamps", bytes <= most ? bytes : 0);
    all_looked_ = false;
    return *lamp_looks_;
}

void LightField::look_at_lamps() const {
    if (lamp_looks().bytes() == 0 || all_looked_) return;
    bind();
    lamp_looks_->bind_storage(BINDING_LAMP_LOOKS);
    const std::size_t lobes = octree_.lobes.size();
    for (std::uint32_t lamp = 0; lamp < gpu_octree_.grid.light_count; ++lamp) {
        set_uniform(look_, 2, lamp);
        for (std::size_t first = 0; first < lobes; first += kLobesAtOnce) {
            const std::size_t last = std::min(lobes, first + kLobesAtOnce);
            set_uniform(look_, 0, static_cast<std::uint32_t>(first));
            set_uniform(look_, 1, static_cast<std::uint32_t>(last));
            look_.dispatch(last - first, kGroup);
        }
    }
    all_looked_ = true;
}

void LightField::show_to_cones() const {
    inject();
    if (!mirrored_) mirrored_.emplace(octree_, LightSettings{});
    if (groups_ != nullptr)
        radiance_ =
            Buffer::of("outgoing radiance", std::span<const gpu::vec4>(radiance_by_groups()));
    bind();
    emitted_.bind_storage(BINDING_SCRATCH_A);
    if (groups_ == nullptr) radiate_.dispatch(octree_.lobes.size(), kGroup);
    mirrored_->filter();
}

void LightField::prepare(const Progress& progress) {
    if (octree_.lobes.empty()) return;
    prepare_rays(GpuLinks::kAllRays, progress);
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
    links_ = GpuLinks(context_, octree_, settings_, progress, rays);
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
    domains_ = &domains;
    groups_ = &links;
    links_ = GpuLinks(links.rows());
}

std::vector<gpu::vec4> LightField::radiance_by_groups() const {
    const std::size_t lobes = octree_.lobes.size();
    const auto indirect = indirect_.read<gpu::vec4>(groups_->groups.count());
    std::vector<gpu::vec4> radiance(lobes);
    for (std::size_t first = 0; first < lobes; first += kLobesAtOnce) {
        const std::size_t count = std::min(kLobesAtOnce, lobes - first);
        const auto direct = direct_.read<gpu::vec4>(count, first);
        const std::span<const gpu::vec4> emitted(emitted_by_lobes_);
        radiate(octree_.lobes.subspan(first, count),
                emitted.empty() ? emitted : emitted.subspan(first, count), direct,
                std::span(groups_->groups.group_of).subspan(first, count), indirect,
                std::span(radiance).subspan(first, count));
    }
    return radiance;
}

/// Lobes of one domain after the other lie side by side, and go to the GPU as they do.
void LightField::publish_groups(bool smooth) {
    const LightGroups& groups = groups_->groups;
    const auto lights = group_gradients(*groups_, octree_.lobes, radiance_by_lobes_,
                                        indirect_.read<gpu::vec4>(groups.count()));
    for (std::uint32_t coarser = 0; coarser <= LightDomains::kMostCoarser; ++coarser) {
        std::vector<std::uint32_t> lobes;
        auto spread = spread_to_lobes(octree_, *domains_, groups, coarser, gpu_octree_.grid, lights,
                                      radiance_by_lobes_, smooth, lobes);
        for (std::size_t i = 0; i < lobes.size(); ++i)
            spread[i].irradiance.w = static_cast<float>(walls_[lobes[i]]);
        for (std::size_t first = 0, last = 0; first < lobes.size(); first = last) {
            while (last < lobes.size() && lobes[last] - lobes[first] == last - first)
                ++last;
            lit_.write(std::span<const gpu::LobeLight>(spread).subspan(first, last - first),
                       lobes[first]);
        }
    }
}

void LightField::forget_indirect() {
    indirect_.clear();
    blacken();
}

void LightField::blacken() {
    std::vector<gpu::LobeLight> black(octree_.lobes.size());
    for (std::size_t i = 0; i < walls_.size(); ++i)
        black[i].irradiance.w = static_cast<float>(walls_[i]);
    lit_.write(black);
}

void LightField::gather() {
    inject();
    bind();
    if (groups_ != nullptr) {
        radiance_by_lobes_ = radiance_by_groups();
        gathered_.write(bounce_along(groups_->rows(), radiance_by_lobes_));
        gathered_.bind_storage(BINDING_SCRATCH_B);
        return;
    }
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

void LightField::publish(bool smooth) {
    if (walls_.empty()) {
        walls_ = walls_beside(octree_);
        blacken();
    }
    if (groups_ != nullptr) {
        publish_groups(smooth);
        return;
    }
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
    if (const LinkRows* rows = links_.on_cpu()) {
        auto lights = light_gradients(*rows, octree_.lobes, radiance_.read<gpu::vec4>(lobes),
                                      indirect_.read<gpu::vec4>(lobes), walls_);
        if (smooth) {
            const auto closed = gpu_octree_.lobes.read<Lobe>(lobes);
            lights = smoothed({octree_.nodes, closed, lights, gpu_octree_.grid});
        }
        lit_.write(lights);
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
    prepare_rays(GpuLinks::kAllRays, {});
    for (int i = 0; i < bounces; ++i) {
        gather();
        std::swap(indirect_, gathered_);
    }
    publish(at_rest);
}

Convergence LightField::converge(double tolerance, int max_bounces) {
    Convergence result;
    if (octree_.lobes.empty()) return {.settled = true};
    prepare_rays(GpuLinks::kAllRays, {});
    Anderson anderson(groups_ != nullptr ? groups_->groups.count() : octree_.lobes.size());
    while (result.bounces < max_bounces && !result.settled) {
        gather();
        result.residual = anderson.step().relative;
        ++result.bounces;
        result.settled = result.bounces >= kLeastBounces && result.residual < tolerance;
    }
    publish(result.settled);
    return result;
}

std::vector<ProbeResult> LightField::measure(std::span<const Probe> probes) const {
    std::vector<gpu::vec4> places;
    for (const Probe& probe : probes) {
        Vec3d relative = probe.position - octree_.grid.origin;
        for (int a = 0; a < 3; ++a)  // far outside is far outside; infinite would be no number
            relative[a] = std::clamp(relative[a], -kFarthest, kFarthest);
        const Vec3f at = vec3_cast<float>(relative);
        places.push_back({at.x, at.y, at.z, 0.0f});
        places.push_back({probe.normal.x, probe.normal.y, probe.normal.z, 0.0f});
    }
    if (runs_compiled()) return measure_compiled(places);
    const Buffer places_buffer = Buffer::of("probes", std::span<const gpu::vec4>(places));
    const Buffer measured("measured", places.size() * sizeof(gpu::vec4));
    bind();
    places_buffer.bind_storage(BINDING_SCRATCH_A);
    measured.bind_storage(BINDING_SCRATCH_B);
    const auto count = static_cast<std::uint32_t>(probes.size());
    set_uniform(probe_indirect_, 0, count);
    probe_indirect_.dispatch(count, kGroup);
    set_uniform(probe_direct_, 0, count);
    for (std::uint32_t light = 0; light < gpu_octree_.grid.light_count; ++light) {
        set_uniform(probe_direct_, 1, light);
        for (std::int32_t row = 0; row < AREA_SAMPLES_OF_PROBE; row += AREA_ROWS_AT_ONCE) {
            set_uniform(probe_direct_, 2, row);
            set_uniform(probe_direct_, 3, row + AREA_ROWS_AT_ONCE);
            probe_direct_.dispatch(count, kGroup);
        }
    }

    return probe_results(measured.read<gpu::vec4>(places.size()));
}

std::vector<ProbeResult> LightField::measure_compiled(std::span<const gpu::vec4> places) const {
    const RayTracer& rays = tracer();
    const auto nodes = gpu_octree_.nodes.map<const Node>();
    const auto lobes = gpu_octree_.lobes.map<const Lobe>();
    const auto lobe_lights = lit_.map<const gpu::LobeLight>();
    std::vector<gpu::vec4> measured(places.size());
    measure_indirect_light({nodes, lobes, lobe_lights, gpu_octree_.grid}, places, measured);
    measure_direct_light({rays, lobes, lights_, gpu_octree_.grid}, places, measured);
    return probe_results(measured);
}

std::vector<gpu::vec4> LightField::read_direct() const {
    inject();
    return direct_.read<gpu::vec4>(octree_.lobes.size());
}

std::vector<gpu::vec4> LightField::read_indirect() const {
    if (groups_ == nullptr) return indirect_.read<gpu::vec4>(octree_.lobes.size());
    const auto of_groups = indirect_.read<gpu::vec4>(groups_->groups.count());
    std::vector<gpu::vec4> of_lobes;
    for (const std::uint32_t group : groups_->groups.group_of)
        of_lobes.push_back(of_groups[group]);
    return of_lobes;
}

}  // namespace glowworm

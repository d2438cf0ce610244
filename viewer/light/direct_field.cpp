#include "viewer/light/direct_field.h"

#include <algorithm>
#include <utility>

#include "viewer/gpu/vec4.h"
#include "viewer/light/direct.h"

namespace glowworm {
namespace {

constexpr std::size_t kGroup = 64;
constexpr std::size_t kLobesAtOnce = 1 << 16;  // a dispatch stays short enough for a display's GPU

/// Whether two lights cast the same shadows.
bool same_place(const gpu::Light& a, const gpu::Light& b) {
    return a.kind == b.kind && a.tag == b.tag && to_vec3(a.position) == to_vec3(b.position) &&
           to_vec3(a.axis) == to_vec3(b.axis) && to_vec3(a.edge_u) == to_vec3(b.edge_u) &&
           to_vec3(a.edge_v) == to_vec3(b.edge_v);
}

}  // namespace

DirectField::DirectField(const Context& context, const OctreeView& octree,
                         const LightSettings& settings, LightGround ground)
    : context_(context),
      octree_(octree),
      settings_(settings),
      gpu_octree_(upload(context, octree, ground.closed, settings)),
      grid_("light grid", sizeof(gpu::LightGrid)),
      irradiance_("direct irradiance", octree.lobes.size() * sizeof(gpu::vec4)),
      tracer_(std::move(ground.tracer)) {}

void DirectField::set_lights(std::vector<gpu::Light> lights) {
    if (!std::ranges::equal(lights, lights_, same_place)) lamp_looks_.reset();
    lights_ = std::move(lights);
    lights_buffer_ = Buffer::of("lights", std::span<const gpu::Light>(lights_));
    gpu_octree_.grid.light_count = static_cast<std::uint32_t>(lights_.size());
    grid_.write(std::span<const gpu::LightGrid>(&gpu_octree_.grid, 1));
    irradiance_.clear();
    injected_lights_ = 0;
    injected_lobes_ = 0;
}

bool DirectField::inject_more() {
    const std::size_t lobes = octree_.lobes.size();
    if (lobes == 0 || injected_lights_ == lights_.size()) return false;
    const std::size_t first = injected_lobes_, last = std::min(lobes, first + kLobesAtOnce);
    if (runs_compiled()) {
        const RayTracer& rays = *tracer();
        const auto closed = gpu_octree_.lobes.map<const Lobe>();
        const auto direct = irradiance_.map<gpu::vec4>();
        add_direct_light({rays, closed, lights_, gpu_octree_.grid}, injected_lights_, first,
                         std::span<gpu::vec4>(direct).subspan(first, last - first));
    } else {
        if (!inject_) inject_ = Program({"inject.comp"});
        bind();
        set_uniform(*inject_, 0, static_cast<std::uint32_t>(first));
        set_uniform(*inject_, 1, static_cast<std::uint32_t>(last));
        set_uniform(*inject_, 2, injected_lights_);
        inject_->dispatch(last - first, kGroup);
    }
    injected_lobes_ = last;
    if (last == lobes) {
        injected_lobes_ = 0;
        ++injected_lights_;
    }
    return true;
}

void DirectField::inject() {
    while (inject_more()) {
    }
}

double DirectField::share_injected() const {
    const auto lobes = static_cast<double>(octree_.lobes.size());
    const auto lights = static_cast<double>(lights_.size());
    if (lobes == 0.0 || lights == 0.0) return 1.0;
    return (injected_lights_ + static_cast<double>(injected_lobes_) / lobes) / lights;
}

const Buffer& DirectField::lamp_looks() {
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

void DirectField::look_at_lamps() {
    if (lamp_looks().bytes() == 0 || all_looked_) return;
    if (!look_) look_ = Program({"lamp_looks.comp"});
    bind();
    lamp_looks_->bind_storage(BINDING_LAMP_LOOKS);
    const std::size_t lobes = octree_.lobes.size();
    for (std::uint32_t lamp = 0; lamp < lights_.size(); ++lamp) {
        set_uniform(*look_, 2, lamp);
        for (std::size_t first = 0; first < lobes; first += kLobesAtOnce) {
            const std::size_t last = std::min(lobes, first + kLobesAtOnce);
            set_uniform(*look_, 0, static_cast<std::uint32_t>(first));
            set_uniform(*look_, 1, static_cast<std::uint32_t>(last));
            look_->dispatch(last - first, kGroup);
        }
    }
    all_looked_ = true;
}

void DirectField::bind() const {
    grid_.bind_uniform(BINDING_LIGHT_GRID);
    gpu_octree_.nodes.bind_storage(BINDING_NODES);
    gpu_octree_.lobes.bind_storage(BINDING_LOBES);
    irradiance_.bind_storage(BINDING_DIRECT);
    lights_buffer_.bind_storage(BINDING_LIGHTS);
}

bool DirectField::runs_compiled() const {
    return glowworm::runs_compiled(context_, settings_);
}

const std::shared_ptr<const RayTracer>& DirectField::tracer() {
    if (!tracer_) {
        const auto closed = gpu_octree_.lobes.map<const Lobe>();
        OctreeView octree = octree_;
        octree.lobes = closed;
        tracer_ = std::make_shared<RayTracer>(octree, settings_.trace);
    }
    return tracer_;
}

}  // namespace glowworm

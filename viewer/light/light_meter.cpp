#include "viewer/light/light_meter.h"

#include <algorithm>
#include <cstdint>

#include "viewer/gpu/vec4.h"
#include "viewer/light/direct.h"
#include "viewer/light/lookup.h"

namespace glowworm {
namespace {

constexpr std::size_t kGroup = 64;
constexpr double kFarthest = 1e7;  // m

/// Of each probe its position, relative to the octree's origin, and its normal.
std::vector<gpu::vec4> places_of(std::span<const Probe> probes, const Vec3d& origin) {
    std::vector<gpu::vec4> places;
    for (const Probe& probe : probes) {
        Vec3d relative = probe.position - origin;
        for (int a = 0; a < 3; ++a)  // far outside is far outside; infinite would be no number
            relative[a] = std::clamp(relative[a], -kFarthest, kFarthest);
        const Vec3f at = vec3_cast<float>(relative);
        places.push_back({at.x, at.y, at.z, 0.0f});
        places.push_back({probe.normal.x, probe.normal.y, probe.normal.z, 0.0f});
    }
    return places;
}

/// Of each place and normal its direct and its indirect irradiance.
std::vector<gpu::vec4> measure_by_shaders(const LightField& light,
                                          std::span<const gpu::vec4> places) {
    const Program probe_direct({"probe_direct.comp"}), probe_indirect({"probe_indirect.comp"});
    const Buffer places_buffer = Buffer::of("probes", places);
    const Buffer measured("measured", places.size_bytes());
    light.bind();
    places_buffer.bind_storage(BINDING_SCRATCH_A);
    measured.bind_storage(BINDING_SCRATCH_B);
    const auto count = static_cast<std::uint32_t>(places.size() / 2);
    set_uniform(probe_indirect, 0, count);
    probe_indirect.dispatch(count, kGroup);
    set_uniform(probe_direct, 0, count);
    for (std::uint32_t lamp = 0; lamp < light.direct().lights().size(); ++lamp) {
        set_uniform(probe_direct, 1, lamp);
        for (std::int32_t row = 0; row < AREA_SAMPLES_OF_PROBE; row += AREA_ROWS_AT_ONCE) {
            set_uniform(probe_direct, 2, row);
            set_uniform(probe_direct, 3, row + AREA_ROWS_AT_ONCE);
            probe_direct.dispatch(count, kGroup);
        }
    }
    return measured.read<gpu::vec4>(places.size());
}

/// The same in compiled code.
std::vector<gpu::vec4> measure_compiled(const LightField& light,
                                        std::span<const gpu::vec4> places) {
    DirectField& direct = light.direct();
    const RayTracer& rays = *direct.tracer();
    const gpu::LightGrid& grid = direct.octree().grid;
    const auto nodes = direct.octree().nodes.map<const Node>();
    const auto lobes = direct.octree().lobes.map<const Lobe>();
    const auto lobe_lights = light.lobe_lights().map<const gpu::LobeLight>();
    std::vector<gpu::vec4> measured(places.size());
    measure_indirect_light({nodes, lobes, lobe_lights, grid}, places, measured);
    measure_direct_light({rays, lobes, direct.lights(), grid}, places, measured);
    return measured;
}

}  // namespace

std::vector<ProbeResult> measure_light(const LightField& light, std::span<const Probe> probes) {
    const auto places = places_of(probes, light.origin());
    const auto measured = light.direct().runs_compiled() ? measure_compiled(light, places)
                                                         : measure_by_shaders(light, places);
    std::vector<ProbeResult> results;
    for (std::size_t i = 0; i < measured.size(); i += 2) {
        results.push_back(
            {to_vec3(measured[i]), to_vec3(measured[i + 1]), measured[i + 1].w > 0.0f});
    }
    return results;
}

}  // namespace glowworm

#include "viewer/light/lookup.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "viewer/gpu/glsl.h"

namespace glowworm {
namespace gpu {
namespace {

struct LookupPass {
    std::span<const Node> nodes;
    std::span<const Lobe> lobes;
    std::span<const LobeLight> lobe_lights;
    LightGrid grid;

#include "shaders/light_lookup.glsl"
};

/// Calls `visit(pass, i)` for i in [0, count), each thread with a pass of its own.
template <typename Visit>
void for_each(const LookupInput& input, std::size_t count, const Visit& visit) {
    const LookupPass prepared{input.nodes, input.lobes, input.lobe_lights, input.grid};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 128), [&](const auto& range) {
        LookupPass pass = prepared;
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            visit(pass, i);
    });
}

}  // namespace
}  // namespace gpu

void measure_indirect_light(const LookupInput& input, std::span<const gpu::vec4> places,
                            std::span<gpu::vec4> measured) {
    gpu::for_each(input, places.size() / 2, [&](gpu::LookupPass& pass, std::size_t i) {
        measured[2 * i + 1] =
            pass.indirect_light(gpu::vec3(places[2 * i]), gpu::vec3(places[2 * i + 1]));
    });
}

std::vector<gpu::LobeLight> light_at(const LookupInput& input,
                                     std::span<const SurfacePlace> places) {
    std::vector<gpu::LobeLight> lights(places.size());
    gpu::for_each(input, places.size(), [&](gpu::LookupPass& pass, std::size_t i) {
        const SurfacePlace& at = places[i];
        const gpu::vec3 position = gpu::vec3_of(at.position), normal = gpu::vec3_of(at.normal);
        lights[i] = pass.light_around(position, normal, 1.0f, true, pass.wall_beside(at.lobe));
        if (lights[i].irradiance.w > 0.0f) return;
        lights[i] = input.lobe_lights[at.lobe];
        lights[i].irradiance =
            gpu::vec4(pass.turned_irradiance(lights[i], pass.lobe_normal(at.lobe), normal), 0.0f);
    });
    return lights;
}

}  // namespace glowworm

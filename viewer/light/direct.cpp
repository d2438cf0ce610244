#include "viewer/light/direct.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "viewer/gpu/glsl.h"
#include "viewer/light/shadow_queue.h"

namespace glowworm {
namespace gpu {
namespace {

struct DirectPass {
    std::span<const Node> nodes;
    std::span<const Lobe> lobes;
    std::span<const Light> lights;
    LightGrid grid;
    ShadowQueue shadows;
    int area_samples = AREA_SAMPLES_OF_SURFACE;

#define UNOCCLUDED shadows.unoccluded
#define AREA_SAMPLES area_samples
#include "shaders/direct_light.glsl"

    /// Works out irradiance_at(i) for i in [begin, end) and has add(i, irradiance) take it.
    template <typename IrradianceAt, typename Add>
    void run(std::size_t begin, std::size_t end, const IrradianceAt& irradiance_at,
             const Add& add) {
        for (std::size_t first = begin; first < end;) {
            shadows.ask();
            std::size_t last = first;
            while (last < end && !shadows.is_full())
                irradiance_at(last++);
            shadows.trace();
            for (; first < last; ++first)
                add(first, irradiance_at(first));
        }
    }
};

}  // namespace
}  // namespace gpu

using gpu::vec3;
using gpu::vec4;

void add_direct_light(const DirectLightInput& input, std::uint32_t light, std::size_t first,
                      std::span<vec4> direct) {
    const gpu::DirectPass prepared{.nodes = {},
                                   .lobes = input.lobes,
                                   .lights = input.lights,
                                   .grid = input.grid,
                                   .shadows = ShadowQueue(&input.tracer)};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, direct.size(), 1024),
                      [&](const auto& range) {
                          gpu::DirectPass pass = prepared;
                          pass.run(
                              range.begin(), range.end(),
                              [&](std::size_t i) {
                                  return pass.direct_irradiance_of_lobe(
                                      light, static_cast<std::uint32_t>(first + i));
                              },
                              [&](std::size_t i, const vec3& e) { direct[i] += vec4(e, 0.0f); });
                      });
}

void measure_direct_light(const DirectLightInput& input, std::span<const vec4> places,
                          std::span<vec4> measured) {
    const gpu::DirectPass prepared{.nodes = {},
                                   .lobes = input.lobes,
                                   .lights = input.lights,
                                   .grid = input.grid,
                                   .shadows = ShadowQueue(&input.tracer),
                                   .area_samples = AREA_SAMPLES_OF_PROBE};
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, places.size() / 2, 64), [&](const auto& range) {
            gpu::DirectPass pass = prepared;
            pass.run(
                range.begin(), range.end(),
                [&](std::size_t i) {
                    return pass.direct_irradiance(vec3(places[2 * i]), vec3(places[2 * i + 1]));
                },
                [&](std::size_t i, const vec3& e) { measured[2 * i] = vec4(e, 0.0f); });
        });
}

}  // namespace glowworm

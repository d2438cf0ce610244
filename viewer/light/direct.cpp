#include "viewer/light/direct.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "viewer/gpu/glsl.h"

namespace glowworm {
namespace gpu {
namespace {

constexpr std::size_t kRaysAtOnce = 1 << 11;  // they and what they hit fit a cache

/// Works a formula out twice: the first time shadow rays are only asked for, then they are traced
/// together, and the second time they are answered. That costs little beside tracing.
struct DirectPass {
    std::span<const Node> nodes;
    std::span<const Lobe> lobes;
    std::span<const Light> lights;
    LightGrid grid;
    const RayTracer* tracer = nullptr;
    int area_samples = AREA_SAMPLES_OF_SURFACE;

    std::vector<ShadowRay> rays = {};
    std::vector<std::uint8_t> seen = {};
    std::size_t answered = 0;
    bool asking = true;

    /// In place of trace.glsl's unoccluded().
    bool answer(vec3 origin, vec3 direction, vec3 from_normal, float t_min, float t_max, uint tag,
                vec3 lamp_normal) {
        if (!asking) return seen[answered++] != 0;
        rays.push_back({{{origin.x, origin.y, origin.z},
                         {direction.x, direction.y, direction.z},
                         {from_normal.x, from_normal.y, from_normal.z},
                         t_min,
                         t_max},
                        {{lamp_normal.x, lamp_normal.y, lamp_normal.z}, tag}});
        return false;
    }

#define UNOCCLUDED answer
#define AREA_SAMPLES area_samples
#include "shaders/direct_light.glsl"

    /// Works out irradiance_at(i) for i in [begin, end) and has add(i, irradiance) take it.
    template <typename IrradianceAt, typename Add>
    void run(std::size_t begin, std::size_t end, const IrradianceAt& irradiance_at,
             const Add& add) {
        for (std::size_t first = begin; first < end;) {
            asking = true;
            rays.clear();
            std::size_t last = first;
            while (last < end && rays.size() < kRaysAtOnce)
                irradiance_at(last++);
            seen.resize(rays.size());
            tracer->look(rays, seen);
            asking = false;
            answered = 0;
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
                                   .tracer = &input.tracer};
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
                                   .tracer = &input.tracer,
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

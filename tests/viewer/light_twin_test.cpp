// Light as compiled code, as shaders and as formulas on the CPU: the same.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "analytic_cave.h"
#include "light_reference.h"
#include "octree/build.h"
#include "octree/close_patches.h"
#include "octree/links.h"
#include "viewer/gpu/context.h"
#include "viewer/light/light_field.h"
#include "viewer/light/light_meter.h"

namespace glowworm {
namespace {

using ::testing::IsEmpty;
using testing::lamp_at;

TEST(Light, TheGpuTracesTheLinksThatTheCpuDoes) {
    const Context context = Context::headless();
    const Octree octree = build_octree(testing::dogleg(0.05f), {.depth = 5});
    const LightSettings settings{.links = 16, .run_on = RunOn::kGpu};
    LightField field(context, octree.view(), lamp_at({0.5, 0.5, 0.5}), settings);
    field.prepare();
    const auto from_gpu = field.links().read();
    const auto from_cpu = trace_links(octree.view(), {.rays = 16, .trace = settings.trace});
    ASSERT_EQ(from_gpu.size(), from_cpu.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < from_cpu.size(); ++i)
        different += from_cpu[i] != from_gpu[i];
    std::cout << different << " of " << from_cpu.size() << " links differ (ties)\n";
    EXPECT_LT(different, from_cpu.size() / 1000);
    EXPECT_THAT(context.errors(), IsEmpty());
}

/// For the dogleg.
Scene lights_of_each_kind() {
    Scene scene = lamp_at({0.5, 0.5, 0.5});
    scene.spot_lights.push_back(
        {"spot", {2.0, 0.5, 0.9}, {0.3, 0.0, -1.0}, 70.0, 0.4, {5.0f, 4.0f, 3.0f}});
    AreaLight panel{"panel", {}, {2.0f, 3.0f, 4.0f}};
    panel.corners[0] = {3.2, 3.2, 0.99};
    panel.corners[1] = {3.2, 3.7, 0.99};
    panel.corners[2] = {3.7, 3.7, 0.99};
    panel.corners[3] = {3.7, 3.2, 0.99};
    scene.area_lights.push_back(panel);
    return scene;
}

TEST(Light, CompiledCodeInjectsAndMeasuresWhatTheShadersDo) {
    const Context context = Context::headless();
    if (!context.device().software) GTEST_SKIP() << "OpenGL does not run on the CPU";
    const Octree octree = build_octree(testing::dogleg(0.05f), {.depth = 5});
    const Scene scene = lights_of_each_kind();
    const LightField compiled(context, octree.view(), scene, {.run_on = RunOn::kCpu});
    const LightField shaded(context, octree.view(), scene, {.run_on = RunOn::kGpu});
    const auto ties = [](const gpu::vec4& a, const gpu::vec4& b) {
        float apart = 0.0f;
        for (int c = 0; c < 3; ++c)
            apart = std::max(apart, std::abs(a[c] - b[c]) / (std::abs(b[c]) + 1e-3f));
        return apart > 1e-4f ? 1u : 0u;
    };
    const auto by_compiled = compiled.read_direct(), by_shaders = shaded.read_direct();
    std::size_t different = 0, lit = 0;
    for (std::size_t i = 0; i < by_shaders.size(); ++i) {
        different += ties(by_compiled[i], by_shaders[i]);
        lit += by_shaders[i].x > 0.0f;
    }
    std::cout << different << " of " << lit << " lit lobes differ (ties)\n";
    EXPECT_GT(lit, by_shaders.size() / 4);
    EXPECT_LE(different, lit / 500);
    EXPECT_THAT(context.errors(), IsEmpty());
}

TEST(Light, TheGpuMeasuresWhatTheFormulasOnTheCpuSay) {
    const Context context = Context::headless();
    const Octree octree = build_octree(testing::dogleg(0.05f), {.depth = 5});
    const Scene scene = lights_of_each_kind();
    std::vector<Probe> probes;
    for (int i = 0; i < 40; ++i) {
        const double along = 0.1 * i;
        probes.push_back({{along, 0.37, 0.0}, {0.0f, 0.0f, 1.0f}});
        probes.push_back({{3.31, along, 1.0}, {0.0f, 0.0f, -1.0f}});
        probes.push_back({{4.0, along, 0.41}, {-1.0f, 0.0f, 0.0f}});
    }
    for (const RunOn run_on : {RunOn::kCpu, RunOn::kGpu, RunOn::kFaster}) {
        const bool tricubic = run_on != RunOn::kFaster;
        LightField field(context, octree.view(), scene,
                         {.links = 16, .tricubic = tricubic, .run_on = run_on});
        field.iterate(3);
        const auto measured = measure_light(field, probes);

        const std::vector<Lobe> closed = close_patches(octree.view());
        OctreeView view = octree.view();
        view.lobes = closed;
        std::vector<Vec3d> direct;
        for (const gpu::vec4& e : field.read_direct())
            direct.push_back({e.x, e.y, e.z});
        const auto indirect = testing::smooth(
            view, testing::bounce(view, trace_links(octree.view(), {.rays = 16}), 16, direct, 3));
        double worst_direct = 0.0, worst_indirect = 0.0;
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const Vec3f at = vec3_cast<float>(probes[i].position - view.grid.origin);
            const Vec3d d = testing::direct_irradiance(view, {}, scene, at, probes[i].normal,
                                                       0.03f * view.grid.voxel_size());
            const Vec3d e =
                testing::look_up(view, indirect, at, probes[i].normal, tricubic).irradiance;
            for (int c = 0; c < 3; ++c) {
                worst_direct = std::max(worst_direct, std::abs(measured[i].direct[c] - d[c]));
                worst_indirect =
                    std::max(worst_indirect, std::abs(measured[i].indirect[c] / e[c] - 1.0));
            }
        }
        std::cout << (tricubic ? "tricubic" : "trilinear") << ": worst difference direct "
                  << worst_direct << " W/m2, indirect " << 100.0 * worst_indirect << " %\n";
        EXPECT_LT(worst_direct, 0.05);  // one of 256 shadow rays to the panel may tie
        EXPECT_LT(worst_indirect, 2e-3);
    }
    EXPECT_THAT(context.errors(), IsEmpty());
}

TEST(Light, CompiledCodeSettlesTurnsAndSmoothesAsTheShadersDo) {
    const Context context = Context::headless();
    if (!context.device().software) GTEST_SKIP() << "OpenGL does not run on the CPU";
    Octree octree = build_octree(testing::dogleg(0.05f), {.depth = 5});
    octree.links = trace_links(octree.view(), {.rays = 50});
    octree.links_per_lobe = 50;
    const auto settled = [&](RunOn run_on) {
        LightField field(context, octree.view(), lights_of_each_kind(),
                         {.links = 50, .run_on = run_on});
        const Convergence convergence = field.converge();
        EXPECT_TRUE(convergence.settled);
        std::cout << convergence.bounces << " bounces, ";
        return field.lobe_lights().read<gpu::LobeLight>(octree.lobes.size());
    };
    const auto compiled = settled(RunOn::kCpu), shaded = settled(RunOn::kGpu);
    // A shadow ray or two tie, of the 36 to the panel, and lobes round there get a little more.
    std::size_t apart = 0, walls = 0;
    double irradiance = 0.0, turn = 0.0, all = 0.0, all_turns = 0.0;
    for (std::size_t i = 0; i < shaded.size(); ++i) {
        walls += compiled[i].irradiance.w != shaded[i].irradiance.w;
        const double e = shaded[i].irradiance.x;
        const double off = std::abs(compiled[i].irradiance.x - e);
        apart += off > 1e-3 * e;
        irradiance += off;
        all += e;
        for (int a = 0; a < 4; ++a) {
            turn += std::abs(compiled[i].turn[0][a] - shaded[i].turn[0][a]);
            all_turns += std::abs(shaded[i].turn[0][a]);
        }
    }
    std::cout << apart << " of " << shaded.size() << " lobes differ, in the mean irradiance by "
              << 100.0 * irradiance / all << " %, its turns by " << 100.0 * turn / all_turns
              << " %\n";
    EXPECT_EQ(walls, 0u);
    EXPECT_LE(apart, shaded.size() / 100);
    EXPECT_LT(irradiance, 1e-4 * all);
    EXPECT_LT(turn, 1e-3 * all_turns);
    EXPECT_THAT(context.errors(), IsEmpty());
}

}  // namespace
}  // namespace glowworm

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

Octree at_depth(const SurfelCloud& cloud, std::uint32_t depth) {
    BuildSettings settings;
    settings.depth = depth;
    return build_octree(cloud, settings);
}

Scene lamp_at(const Vec3d& position) {
    Scene scene;
    scene.point_lights.push_back({"lamp", position, {10.0f, 10.0f, 10.0f}});
    return scene;
}

TEST(Light, BehindTheBendItIsBlackWithoutBouncesAndLitWithThem) {
    const Context context = Context::headless();
    const Octree octree = at_depth(testing::dogleg(0.03f), 6);
    LightField field(context, octree.view(), lamp_at({0.5, 0.5, 0.5}));
    const std::vector<Probe> probes = {{{1.0, 0.5, 0.0}, {0.0f, 0.0f, 1.0f}},
                                       {{3.5, 3.5, 0.0}, {0.0f, 0.0f, 1.0f}}};
    const auto dark = measure_light(field, probes);
    EXPECT_GT(dark[0].direct.x, 1.0f);
    EXPECT_EQ(dark[1].direct.x, 0.0f);
    EXPECT_EQ(dark[1].indirect.x, 0.0f);
    field.iterate(1);
    EXPECT_GT(measure_light(field, probes)[0].indirect.x, 0.0f);
    field.iterate(4);
    const auto lit = measure_light(field, probes);
    EXPECT_EQ(lit[1].direct.x, 0.0f);
    EXPECT_GT(lit[1].indirect.x, 1e-4f);
    field.forget_indirect();
    EXPECT_EQ(measure_light(field, probes)[1].indirect.x, 0.0f);
    EXPECT_THAT(context.errors(), IsEmpty());
}

TEST(Light, TheGpuTracesTheLinksThatTheCpuDoes) {
    const Context context = Context::headless();
    const Octree octree = at_depth(testing::dogleg(0.05f), 5);
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
    const Octree octree = at_depth(testing::dogleg(0.05f), 5);
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
    const Octree octree = at_depth(testing::dogleg(0.05f), 5);
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

TEST(Light, FourHundredLampsAddUpToTheirSum) {
    const Context context = Context::headless();
    const Octree octree = at_depth(testing::dogleg(0.1f), 4);
    const std::vector<Probe> probes = {{{1.0, 0.5, 0.0}, {0.0f, 0.0f, 1.0f}},
                                       {{2.0, 0.0, 0.5}, {0.0f, 1.0f, 0.0f}}};
    LightField one(context, octree.view(), lamp_at({0.5, 0.5, 0.5}), {.links = 16});
    one.iterate(2);
    Scene many;
    for (int i = 0; i < 200; ++i) {
        many.point_lights.push_back({"lamp", {0.5, 0.5, 0.5}, {0.04f, 0.04f, 0.04f}});
        // Dark ones must not end the sum early either.
        many.spot_lights.push_back(
            {"spot", {0.5, 0.5, 0.5}, {1.0, 0.0, 0.0}, 170.0, 0.1, {0.0f, 0.0f, 0.0f}});
    }
    LightField sum(context, octree.view(), many, {.links = 16});
    sum.iterate(2);
    for (std::size_t i = 0; i < probes.size(); ++i) {
        const ProbeResult a = measure_light(one, probes)[i], b = measure_light(sum, probes)[i];
        EXPECT_NEAR(b.direct.x / a.direct.x, 0.8, 1e-4);
        EXPECT_NEAR(b.indirect.x / a.indirect.x, 0.8, 1e-4);
    }
}

TEST(Light, ProbesAwayFromEverySurfaceAndBeyondNumbersSaySo) {
    const Context context = Context::headless();
    const Octree octree = at_depth(testing::dogleg(0.1f), 4);
    LightField field(context, octree.view(), lamp_at({0.5, 0.5, 0.5}), {.links = 16});
    field.iterate(2);
    const std::vector<Probe> probes = {{{1.0, 0.5, 0.0}, {0.0f, 0.0f, 1.0f}},
                                       {{1.0, 0.5, 0.0}, {0.0f, 0.0f, -1.0f}},  // into the rock
                                       {{100.0, 0.5, 0.0}, {0.0f, 0.0f, 1.0f}},
                                       {{1e300, 0.5, 0.0}, {0.0f, 0.0f, 1.0f}}};
    const auto measured = measure_light(field, probes);
    EXPECT_TRUE(measured[0].on_surface);
    for (std::size_t i = 1; i < probes.size(); ++i) {
        EXPECT_FALSE(measured[i].on_surface) << i;
        EXPECT_EQ(measured[i].indirect.x, 0.0f) << i;
        EXPECT_TRUE(std::isfinite(measured[i].direct.x)) << i;
    }
}

TEST(Light, ABlackCaveAndAnEmptySceneStayBlack) {
    const Context context = Context::headless();
    const Octree octree = at_depth(testing::dogleg(0.1f), 4);
    LightField field(context, octree.view(), Scene{});
    EXPECT_TRUE(field.converge().settled);
    for (const gpu::vec4& e : field.read_indirect())
        EXPECT_EQ(e.x, 0.0f);
    EXPECT_THAT(measure_light(field, {}), IsEmpty());
}

TEST(Light, AWhiteCaveHasAFixedPointAndAMovedLampIsForgotten) {
    const Context context = Context::headless();
    SurfelCloud cloud = testing::closed_room({0, 0, 0}, {2, 2, 2}, 0.05f);
    for (Surfel& surfel : cloud.surfels)
        surfel.albedo = {1.0f, 1.0f, 1.0f};
    const Octree octree = at_depth(cloud, 4);
    LightField field(context, octree.view(), lamp_at({1.0, 1.0, 1.0}));
    const Convergence first = field.converge();
    EXPECT_TRUE(first.settled) << first.residual;
    const std::vector<Probe> probes = {{{0.5, 1.0, 0.0}, {0.0f, 0.0f, 1.0f}}};
    const float bright = measure_light(field, probes)[0].indirect.x;
    EXPECT_TRUE(std::isfinite(bright));

    Scene dimmer = lamp_at({1.0, 1.0, 1.0});
    dimmer.point_lights[0].radiant_intensity = {5.0f, 5.0f, 5.0f};
    field.set_scene(dimmer);
    EXPECT_TRUE(field.converge().settled);
    EXPECT_NEAR(measure_light(field, probes)[0].indirect.x / bright, 0.5f, 0.01f);
}

TEST(Light, WhateverItStartsFromAWhiteCaveSettlesAtTheSame) {
    const Context context = Context::headless();
    SurfelCloud cloud = testing::closed_room({0, 0, 0}, {2, 2, 2}, 0.05f);
    for (Surfel& surfel : cloud.surfels)
        surfel.albedo = {0.99f, 0.99f, 0.99f};
    const Octree octree = at_depth(cloud, 4);
    const std::vector<Probe> probes = {{{0.5, 1.0, 0.0}, {0.0f, 0.0f, 1.0f}}};
    LightField fresh(context, octree.view(), lamp_at({1.0, 1.0, 1.0}));
    EXPECT_TRUE(fresh.converge(1e-5).settled);
    const float truth = measure_light(fresh, probes)[0].indirect.x;
    for (const float start : {1e-9f, 1e4f, 1e9f, 1e12f}) {
        Scene bright = lamp_at({1.0, 1.0, 1.0});
        bright.point_lights[0].radiant_intensity = {start, start, start};
        LightField field(context, octree.view(), bright);
        field.converge();
        field.set_scene(lamp_at({1.0, 1.0, 1.0}));
        EXPECT_TRUE(field.converge(1e-5).settled) << start;
        EXPECT_NEAR(measure_light(field, probes)[0].indirect.x / truth, 1.0f, 0.01f) << start;
    }
}

TEST(Light, WhatIsNoNumberInAFileDoesNotSpread) {
    const Context context = Context::headless();
    Octree octree = at_depth(testing::dogleg(0.1f), 4);
    const float nan = std::nanf(""), infinite = INFINITY;
    for (std::size_t i = 0; i + 7 < octree.lobes.size(); i += 40) {
        octree.lobes[i].albedo[1] = nan;
        octree.lobes[i + 1].albedo[0] = infinite;
        octree.lobes[i + 2].ndf[2] = nan;
        octree.lobes[i + 3].position[0] = nan;
        octree.lobes[i + 4].position[2] = infinite;
        octree.lobes[i + 5].plane_sigma = nan;
        octree.lobes[i + 6].spacing = infinite;
        octree.lobes[i + 7].ndf[0] = infinite;
    }
    std::vector<Probe> probes;
    for (int i = 0; i < 40; ++i)
        probes.push_back({{0.1 * i, 0.37, 0.0}, {0.0f, 0.0f, 1.0f}});
    for (const Gather gather : {Gather::kLinks, Gather::kCones}) {
        LightField field(context, octree.view(), lamp_at({0.5, 0.5, 0.5}),
                         {.gather = gather, .links = 16});
        EXPECT_TRUE(field.converge(1e-3).settled);
        int lit = 0;
        for (const ProbeResult& result : measure_light(field, probes)) {
            for (int c = 0; c < 3; ++c) {
                EXPECT_TRUE(std::isfinite(result.direct[c]));
                EXPECT_TRUE(std::isfinite(result.indirect[c]));
            }
            lit += result.indirect.y > 0.0f;
        }
        EXPECT_GT(lit, 20);
    }
}

TEST(Light, BakedLinksGiveTheSameLightAsTracedOnes) {
    const Context context = Context::headless();
    Octree octree = at_depth(testing::dogleg(0.1f), 4);
    const Scene scene = lamp_at({0.5, 0.5, 0.5});
    LightField traced(context, octree.view(), scene);
    traced.iterate(2);
    octree.links = trace_links(octree.view(), {.rays = 128});
    octree.links_per_lobe = 128;
    LightField baked(context, octree.view(), scene, {.run_on = RunOn::kGpu});
    baked.iterate(2);
    const auto a = traced.read_indirect();
    const auto b = baked.read_indirect();
    for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_NEAR(a[i].x, b[i].x, 1e-5f * b[i].x);  // one by compiled code, one by shaders
}

TEST(Light, CompiledCodeSettlesTurnsAndSmoothesAsTheShadersDo) {
    const Context context = Context::headless();
    if (!context.device().software) GTEST_SKIP() << "OpenGL does not run on the CPU";
    Octree octree = at_depth(testing::dogleg(0.05f), 5);
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

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "analytic_cave.h"
#include "octree/build.h"
#include "octree/links.h"
#include "viewer/gpu/context.h"
#include "viewer/light/light_field.h"
#include "viewer/light/light_meter.h"

namespace glowworm {
namespace {

using ::testing::IsEmpty;
using testing::lamp_at;

Octree at_depth(const SurfelCloud& cloud, std::uint32_t depth) {
    BuildSettings settings;
    settings.depth = depth;
    return build_octree(cloud, settings);
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

}  // namespace
}  // namespace glowworm

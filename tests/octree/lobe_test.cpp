#include "octree/lobe.h"

#include "clouds.h"
#include "octree/area_lights.h"
#include "octree/build.h"
#include "octree/error.h"
#include "octree/pack.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::surfel_at;

LobeSample sample(const Vec3d& position, const Vec3d& normal, double area = 1.0) {
    LobeSample s;
    s.position = position;
    s.ndf = normal;
    s.albedo = {0.5, 0.5, 0.5};
    s.area = area;
    return s;
}

std::vector<Lobe> lobes_of(const std::vector<LobeSample>& samples) {
    LeafSums leaf;
    leaf.begin({0, 0, 0}, 1.0);
    for (const LobeSample& s : samples)
        leaf.add(s);
    std::array<Lobe, kMaxLobes> lobes;
    const std::size_t count = leaf.finish(lobes);
    return {lobes.begin(), lobes.begin() + static_cast<std::ptrdiff_t>(count)};
}

TEST(Lobes, AFlatPatchIsOneLobeInItsMiddle) {
    const auto lobes =
        lobes_of({sample({0.2, 0.2, 0.5}, {0, 0, 1}), sample({0.4, 0.2, 0.5}, {0, 0, 1}),
                  sample({0.3, 0.8, 0.5}, {0, 0, 1}, 2.0)});
    ASSERT_EQ(lobes.size(), 1u);
    EXPECT_FLOAT_EQ(lobes[0].position[0], 0.3f);
    EXPECT_FLOAT_EQ(lobes[0].position[1], 0.5f);
    EXPECT_FLOAT_EQ(lobes[0].position[2], 0.5f);
    EXPECT_FLOAT_EQ(lobes[0].area, 4.0f);
    EXPECT_NEAR(lobes[0].plane_sigma, 0.0f, 1e-7f);
    EXPECT_EQ(lobes[0].patch_min & 0xff, 51u);        // 0.2
    EXPECT_EQ(lobes[0].patch_max >> 8 & 0xff, 204u);  // 0.8
    EXPECT_FLOAT_EQ(lobes[0].spacing, std::sqrt(4.0f / 3.0f));
}

TEST(Lobes, PlaneSigmaIsTheScatterAlongTheNormal) {
    const Vec3d n = normalized(Vec3d{1, 2, 3});
    const auto lobes = lobes_of(
        {sample(Vec3d{0.5, 0.5, 0.5} + n * 0.01, n), sample(Vec3d{0.5, 0.5, 0.5} + n * -0.01, n)});
    ASSERT_EQ(lobes.size(), 1u);
    EXPECT_NEAR(lobes[0].plane_sigma, 0.01f, 1e-6f);
}

TEST(Lobes, BothSidesOfAThinWallStayApart) {
    const auto lobes =
        lobes_of({sample({0.5, 0.5, 0.4}, {0, 0, -1}), sample({0.5, 0.5, 0.6}, {0, 0, 1}, 2.0)});
    ASSERT_EQ(lobes.size(), 2u);
    EXPECT_FLOAT_EQ(lobes[0].ndf[2], 1.0f) << "the larger one first";
    EXPECT_FLOAT_EQ(lobes[1].ndf[2], -1.0f);
    EXPECT_FLOAT_EQ(lobes[1].position[2], 0.4f);
}

TEST(Lobes, WallAndFloorStayApartAndABendOfFiftyDegreesDoesNot) {
    const auto bend = [](double degrees) {
        const double a = degrees * std::numbers::pi / 180.0;
        return lobes_of({sample({0.5, 0.5, 0.5}, {0, 0, 1}),
                         sample({0.5, 0.5, 0.5}, {std::sin(a), 0, std::cos(a)})})
            .size();
    };
    EXPECT_EQ(bend(90), 2u);
    EXPECT_EQ(bend(65), 2u);
    EXPECT_EQ(bend(50), 1u);
    EXPECT_EQ(bend(20), 1u);
}

TEST(Lobes, NoisyNormalsShortenTheNdfOfOneLobe) {
    std::vector<LobeSample> samples;
    for (int i = 0; i < 8; ++i) {
        const double a = i * std::numbers::pi / 4.0;
        samples.push_back(
            sample({0.5, 0.5, 0.5}, normalized(Vec3d{0.4 * std::cos(a), 0.4 * std::sin(a), 1.0})));
    }
    const auto lobes = lobes_of(samples);
    ASSERT_EQ(lobes.size(), 1u);
    EXPECT_NEAR(lobes[0].ndf[2], 1.0 / std::sqrt(1.16), 1e-6);
}

TEST(Lobes, WhatEmitsIsNeverMixedWithSurface) {
    LobeSample lamp = sample({0.5, 0.5, 0.5}, {0, 0, 1});
    lamp.light = 3;
    lamp.emission = {12, 6, 3};
    LobeSample glow = sample({0.5, 0.5, 0.5}, {0, 0, 1});
    glow.emission = {1, 0, 0};
    const auto lobes = lobes_of({sample({0.5, 0.5, 0.5}, {0, 0, 1}), lamp});
    ASSERT_EQ(lobes.size(), 2u);
    EXPECT_EQ(lobes[0].light, 0u);
    EXPECT_EQ(lobes[0].emission, 0u);
    EXPECT_EQ(lobes[1].light, 3u);
    EXPECT_EQ(unpack_rgb9e5(lobes[1].emission), (Vec3f{12, 6, 3}));
    EXPECT_EQ(lobes_of({sample({0.5, 0.5, 0.5}, {0, 0, 1}), glow}).size(), 2u);
    EXPECT_EQ(lobes_of({sample({0, 0, 0}, {0, 0, 1}), sample({0, 0, 0}, {0, 0, -1}), lamp}).size(),
              3u);
}

AreaLight ceiling_lamp() {
    AreaLight light;
    light.name = "ceiling";
    light.corners[0] = {1, 1, 3};
    light.corners[1] = {1, 2, 3};
    light.corners[2] = {3, 2, 3};
    light.corners[3] = {3, 1, 3};  // seen from below counter-clockwise: shines down
    light.radiance = {10, 9, 8};
    return light;
}

TEST(AreaLights, BecomeSamplesWithTheirIndexRadianceAndArea) {
    SurfelCloud cloud = testing::sphere_cloud(1000);
    const AreaLight light = ceiling_lamp();
    add_area_lights(cloud, std::span(&light, 1));
    double area = 0.0;
    for (const Surfel& s : cloud.surfels) {
        if (s.light == 0) continue;
        EXPECT_EQ(s.light, 1u);
        EXPECT_EQ(s.emission, (Vec3f{10, 9, 8}));
        EXPECT_EQ(s.normal, vec3_cast<float>(light.normal()));
        area += std::numbers::pi * s.radius * s.radius;
    }
    EXPECT_NEAR(area, 2.0, 1e-5);
    ASSERT_EQ(cloud.area_lights.size(), 1u);
}

TEST(AreaLights, AdoptTheSamplesThatAreThereAlready) {
    SurfelCloud cloud;
    const AreaLight light = ceiling_lamp();
    for (float x = 1.05f; x < 3.0f; x += 0.1f) {
        for (float y = 1.05f; y < 2.0f; y += 0.1f) {
            Surfel s = surfel_at({x, y, 3.0f}, vec3_cast<float>(light.normal()), 0.0564f);
            s.emission = {10, 9, 8};
            cloud.surfels.push_back(s);
        }
    }
    cloud.surfels.push_back(surfel_at({2, 1.5f, 3.0f}, {0, 0, -1}, 0.05f));  // ceiling, not lamp
    const std::size_t before = cloud.surfels.size();
    add_area_lights(cloud, std::span(&light, 1));
    EXPECT_EQ(cloud.surfels.size(), before);
    EXPECT_EQ(cloud.surfels.front().light, 1u);
    EXPECT_EQ(cloud.surfels.back().light, 0u);
}

TEST(AreaLights, ARectangleWithoutAreaIsNamed) {
    SurfelCloud cloud = testing::sphere_cloud(10);
    AreaLight light;
    light.name = "broken lamp";
    try {
        add_area_lights(cloud, std::span(&light, 1));
        FAIL() << "accepted";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("broken lamp"));
    }
}

}  // namespace
}  // namespace glowworm

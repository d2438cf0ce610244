#include "preprocess/surface/surfel_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "octree/error.h"
#include "preprocess/surface/albedo.h"
#include "preprocess/surface/surface.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

TEST(Albedo, BytesSurviveTheWayToLinearAndBack) {
    for (int i = 0; i < 256; ++i) {
        const auto byte = static_cast<std::uint8_t>(i);
        EXPECT_EQ(linear_to_srgb(srgb_to_linear(byte)), byte);
    }
    EXPECT_FLOAT_EQ(srgb_to_linear(0), 0.0f);
    EXPECT_FLOAT_EQ(srgb_to_linear(255), 1.0f);
    EXPECT_NEAR(srgb_to_linear(188), 0.5029f, 1e-4f);
    EXPECT_EQ(linear_to_srgb(-1.0f), 0);
    EXPECT_EQ(linear_to_srgb(7.0f), 255);
    EXPECT_EQ(linear_to_srgb(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Albedo, IntensitiesBecomeGreyWithTheDefaultAsTheirMedian) {
    Points points;
    for (int i = 0; i <= 1000; ++i) {
        points.positions.push_back({});
        points.intensities.push_back(static_cast<float>(i) * 4.0f);
    }
    points.intensities[3] = std::numeric_limits<float>::quiet_NaN();
    AlbedoSource source{};
    const std::vector<Rgb8> albedo = albedo_bytes(points, 0.5f, source);
    EXPECT_EQ(source, AlbedoSource::kIntensities);
    EXPECT_NEAR(srgb_to_linear(albedo[500].r), 0.5f, 0.01f);
    EXPECT_NEAR(srgb_to_linear(albedo[250].g), 0.25f, 0.01f);
    EXPECT_NEAR(srgb_to_linear(albedo[0].b), 0.02f, 0.003f);
    EXPECT_NEAR(srgb_to_linear(albedo[1000].b), 0.95f, 0.01f);

    points.intensities.assign(points.size(), 0.0f);
    EXPECT_EQ(albedo_bytes(points, 0.5f, source)[5], (Rgb8{188, 188, 188}));
    EXPECT_EQ(source, AlbedoSource::kDefault);
}

TEST(SurfelPoints, TheWayThroughColumnsLosesNothing) {
    testing::Shape room = testing::make_room(3000);
    testing::add_noise(room, 0.003);
    room.cloud.origin = {500000, 4000000, 300};
    room.cloud.stations[0].position += room.cloud.origin;
    testing::Random random;
    for (std::size_t i = 0; i < room.normals.size(); ++i) {
        const auto byte = [&] { return static_cast<std::uint8_t>(random.uniform(0, 256)); };
        room.cloud.points.colours.push_back({byte(), byte(), byte()});
        room.cloud.points.emissions.push_back(i % 100 ? Vec3f{} : Vec3f{1, 2, 3});
    }
    const SurfelCloud before = make_surfels(room.cloud, {});
    SurfelDefaults defaults;
    const SurfelCloud after = to_surfels(to_points(before), 0.5f, &defaults);
    ASSERT_EQ(after.surfels.size(), before.surfels.size());
    EXPECT_EQ(std::memcmp(after.surfels.data(), before.surfels.data(),
                          before.surfels.size() * sizeof(Surfel)),
              0);
    EXPECT_EQ(after.origin, before.origin);
    EXPECT_FALSE(defaults.ndf_missing || defaults.radius_missing || defaults.colour_missing);
}

TEST(SurfelPoints, MissingColumnsGetTheirDefaults) {
    testing::Shape wall = testing::make_wall(10000, 1.0);
    wall.cloud.points.normals = wall.normals;
    wall.cloud.points.stations.clear();
    SurfelDefaults defaults;
    const SurfelCloud cloud = to_surfels(wall.cloud, 0.3f, &defaults);
    EXPECT_TRUE(defaults.ndf_missing && defaults.radius_missing && defaults.colour_missing);
    ASSERT_EQ(cloud.surfels.size(), 10000u);
    double area = 0.0;
    for (const Surfel& s : cloud.surfels) {
        EXPECT_EQ(s.ndf_length, 1.0f);
        EXPECT_NEAR(s.albedo.y, 0.3f, 0.005f);
        area += std::numbers::pi * s.radius * s.radius;
    }
    std::printf("    area of the discs on 1 m²: %.4f\n", area);
    EXPECT_NEAR(area, 1.0, 0.05);
}

TEST(SurfelPoints, BrokenPointsAreLeftOut) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    PointCloud cloud;
    cloud.points.positions = {{0, 0, 0}, {kNaN, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    cloud.points.normals = {{0, 0, 2}, {0, 0, 1}, {0, 0, 0}, {0, kNaN, 1}};
    const SurfelCloud surfels = to_surfels(cloud);
    ASSERT_EQ(surfels.surfels.size(), 1u);
    EXPECT_EQ(surfels.surfels[0].normal, (Vec3f{0, 0, 1}));
}

TEST(SurfelPoints, ACloudWithoutNormalsIsToldToRunSurface) {
    const testing::Shape wall = testing::make_wall(10, 1.0);
    try {
        to_surfels(wall.cloud);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kDegenerate);
        EXPECT_THAT(error.what(), ::testing::HasSubstr("glowworm surface"));
    }
    EXPECT_THROW(to_surfels({}), Error);
}

}  // namespace
}  // namespace glowworm

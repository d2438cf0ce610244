#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "octree/error.h"
#include "preprocess/surface/surface.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

using testing::Shape;

/// What making surfels of the cloud ends with; prints the sentence.
ExitCode code_of(const PointCloud& cloud) {
    try {
        make_surfels(cloud, {});
    } catch (const Error& error) {
        std::printf("    %s\n", error.what());
        return error.code();
    }
    return ExitCode::kDone;
}

PointCloud cloud_of(std::vector<Vec3f> positions) {
    PointCloud cloud;
    cloud.points.positions = std::move(positions);
    cloud.stations = {testing::station_at({0, 0, 1})};
    return cloud;
}

TEST(DegenerateSurface, BrokenAndDoubledPointsAreLeftOutAndCounted) {
    Shape wall = testing::make_wall(5000, 1.0);
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInf = std::numeric_limits<float>::infinity();
    for (const Vec3f& p : {Vec3f{kNaN, 0, 0}, Vec3f{0, kInf, 0}, Vec3f{0, 0, 1e30f},
                           wall.cloud.points.positions[7], Vec3f{0.5f, 0.5f, 400.0f}}) {
        wall.cloud.points.positions.push_back(p);
        wall.cloud.points.stations.push_back(0);
    }
    SurfaceReport report;
    EXPECT_EQ(make_surfels(wall.cloud, {}, &report).surfels.size(), 5000u);
    EXPECT_EQ(report.points, 5005u);
    EXPECT_EQ(report.not_finite, 3u);
    EXPECT_EQ(report.duplicates, 1u);
    EXPECT_EQ(report.isolated, 1u);
}

TEST(DegenerateSurface, CloudsWithoutASurfaceAreDegenerate) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    std::vector<Vec3f> line;
    for (int i = 0; i < 1000; ++i)
        line.push_back({static_cast<float>(i) * 0.01f, 0, 0});
    EXPECT_EQ(code_of(cloud_of({})), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of({{1, 2, 3}})), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of({{1, 2, 3}, {4, 5, 6}})), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of({{1, 2, 3}, {4, 5, 6}, {4, 5, 7}})), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of(std::vector<Vec3f>(1000, Vec3f{1, 2, 3}))), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of(std::vector<Vec3f>(10, Vec3f{kNaN, 0, 0}))), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of(line)), ExitCode::kDegenerate);
}

TEST(DegenerateSurface, FourPointsMakeASurface) {
    const SurfelCloud cloud =
        make_surfels(cloud_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), {});
    ASSERT_EQ(cloud.surfels.size(), 4u);
    for (const Surfel& s : cloud.surfels)
        EXPECT_GT(s.normal.z, 0.999f);
}

TEST(DegenerateSurface, DensityMayVaryAThousandfold) {
    // A wall whose points thin out from the middle as they do in front of a scanner.
    Shape shape;
    testing::Random random;
    for (int i = 0; i < 40000; ++i) {
        const double r = 0.02 * std::exp(random.uniform(0.0, 5.0));
        const double phi = random.uniform(0.0, 2.0 * std::numbers::pi);
        testing::add_point(shape, {r * std::cos(phi), r * std::sin(phi), 0}, {0, 0, 1});
    }
    shape.cloud.stations = {testing::station_at({0, 0, 1.0})};
    testing::add_noise(shape, 0.001);
    SurfaceReport report;
    const SurfelCloud cloud = make_surfels(shape.cloud, {}, &report);
    EXPECT_GT(cloud.surfels.size(), 39900u);
    std::size_t wrong = 0;
    for (const Surfel& s : cloud.surfels)
        wrong += s.normal.z < 0.9f;
    std::printf("    %zu of %zu off by more than 26 deg\n", wrong, cloud.surfels.size());
    EXPECT_LT(wrong, 200u);
}

}  // namespace
}  // namespace glowworm

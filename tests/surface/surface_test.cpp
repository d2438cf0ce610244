#include "preprocess/surface/surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "surface/accuracy.h"
#include "surface/measure.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

using testing::Accuracy;
using testing::measure;
using testing::Shape;
using testing::without_viewpoints;

TEST(Surface, NormalsOfASphereSeenFromInsideFaceItsMiddle) {
    const Accuracy accuracy = measure("sphere", testing::make_sphere(60000, 2.0));
    EXPECT_LT(accuracy.median_deg, 0.3);
    EXPECT_LT(accuracy.p95_deg, 0.7);
    EXPECT_EQ(accuracy.right_side, 1.0);
}

TEST(Surface, NormalsSurviveThreeMillimetresOfNoise) {
    for (auto [name, shape] : {std::pair{"wall", testing::make_wall(20000, 2.0)},
                               std::pair{"sphere", testing::make_sphere(60000, 2.0)},
                               std::pair{"tube", testing::make_tube(60000, 1.0, 8.0)}}) {
        testing::add_noise(shape, 0.003);
        SurfaceReport report;
        const Accuracy accuracy = measure(name, shape, &report);
        EXPECT_LT(accuracy.median_deg, 1.5) << name;
        EXPECT_LT(accuracy.p95_deg, 3.5) << name;
        EXPECT_GT(accuracy.right_side, 0.999) << name;
        EXPECT_NEAR(report.range_noise, 0.003, 0.0002) << name;
    }
}

TEST(Surface, DiscsHaveTheAreaOfTheSurfaceTheyTile) {
    for (auto [name, shape] : {std::pair{"wall", testing::make_wall(20000, 2.0)},
                               std::pair{"sphere", testing::make_sphere(60000, 2.0)},
                               std::pair{"room", testing::make_room(60000)}}) {
        EXPECT_NEAR(measure(name, shape).area / shape.area, 1.0, 0.04) << name;
        testing::add_noise(shape, 0.003);
        EXPECT_NEAR(measure(name, shape).area / shape.area, 1.0, 0.04) << name;
    }
}

TEST(Surface, DiscsTileTheRingsOfANearScanner) {
    // Rings 20 mm apart with a point every millimetre: the nearest eight are all on one ring.
    Shape shape;
    testing::Random random;
    for (int ring = 0; ring < 40; ++ring) {
        for (int i = 0; i < 800; ++i) {
            testing::add_point(shape, {i * 0.001 + random.uniform(0, 0.0005), ring * 0.02, 0.0},
                               {0, 0, 1});
        }
    }
    shape.cloud.stations = {testing::station_at({0.4, 0.4, 1.5})};
    shape.area = 0.8 * 0.8;
    const Accuracy accuracy = measure("rings", shape);
    EXPECT_NEAR(accuracy.area / shape.area, 1.0, 0.2);
    testing::add_noise(shape, 0.001);
    EXPECT_LT(measure("rings, 1 mm noise", shape).p95_deg, 4.0);
}

TEST(Surface, FacesOfARoomMeetInASharpEdge) {
    const Shape room = testing::make_room(60000);
    const Accuracy sharp = measure("room", room);
    SurfaceSettings settings;
    settings.sharp_edges = false;
    const SurfelCloud rounded = make_surfels(room.cloud, settings);
    const Accuracy blunt = testing::compare(rounded.surfels, room.normals);
    std::printf("    95 %% without the edges: %.2f deg\n", blunt.p95_deg);
    EXPECT_LT(sharp.p95_deg, 1.0);
    EXPECT_GT(blunt.p95_deg, 10.0);
}

TEST(Surface, TheSameBytesComeFromOneThreadAndFromSeveral) {
    Shape shape = testing::make_room(20000);
    testing::add_noise(shape, 0.003);
    for (const Shape& s : {shape, without_viewpoints(shape)}) {
        const auto run = [&](std::size_t threads) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            return make_surfels(s.cloud, {}).surfels;
        };
        const std::vector<Surfel> one = run(1);
        const std::vector<Surfel> four = run(4);
        ASSERT_EQ(one.size(), four.size());
        EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(Surfel)), 0);
    }
}

TEST(Surface, SurfelsComeInTheOrderOfThePointsAndWithinTheirRanges) {
    Shape shape = testing::make_room(5000);
    testing::add_noise(shape, 0.003);
    const SurfelCloud cloud = make_surfels(shape.cloud, {});
    ASSERT_EQ(cloud.surfels.size(), 5000u);
    for (std::size_t i = 0; i < cloud.surfels.size(); ++i) {
        const Surfel& s = cloud.surfels[i];
        EXPECT_EQ(s.position, shape.cloud.points.positions[i]);
        EXPECT_NEAR(length(s.normal), 1.0f, 1e-5f);
        EXPECT_GT(s.radius, 0.0f);
        EXPECT_GT(s.ndf_length, 0.0f);
        EXPECT_LE(s.ndf_length, 1.0f);
    }
}

TEST(Surface, ProgressGrowsToTheEnd) {
    std::uint64_t last = 0, end = 0;
    const Shape wall = testing::make_wall(3000, 1.0);
    make_surfels(wall.cloud, {}, nullptr, [&](std::uint64_t done, std::uint64_t total) {
        EXPECT_GE(done, last);
        last = done;
        end = total;
    });
    EXPECT_EQ(last, end);
    EXPECT_GT(end, 0u);
}

}  // namespace
}  // namespace glowworm

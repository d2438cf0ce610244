#include "preprocess/surface/surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <limits>

#include "octree/error.h"
#include "surface/accuracy.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

using testing::Accuracy;
using testing::Shape;

/// Makes surfels of a shape, prints and returns how true they are. Next to none of the points may
/// be left out.
Accuracy measure(const char* what, const Shape& shape, SurfaceReport* report_out = nullptr) {
    SurfaceReport report;
    const SurfelCloud cloud = make_surfels(shape.cloud, {}, &report);
    EXPECT_GT(cloud.surfels.size(), shape.normals.size() * 999 / 1000);
    const Accuracy accuracy =
        testing::compare(cloud.surfels, testing::truth_of(cloud.surfels, shape));
    testing::print(what, accuracy, report);
    if (shape.area > 0.0) std::printf("    area of the discs: %.4f\n", accuracy.area / shape.area);
    if (report_out) *report_out = report;
    return accuracy;
}

/// Of unknown stations, and in a frame whose origin is nowhere near.
Shape without_viewpoints(Shape shape) {
    shape.cloud.origin = {300.0, 200.0, 100.0};
    for (Station& station : shape.cloud.stations)
        station.has_viewpoint = false;
    return shape;
}

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

TEST(Surface, BothSidesOfACurtainThinnerThanTheNeighbourhoodFaceTheirOwnStation) {
    for (const int n : {20000, 2000}) {  // neighbourhoods of 2 cm and of 7 cm
        Shape curtain = testing::make_curtain(n, 0.05);
        testing::add_noise(curtain, 0.003);
        const Accuracy accuracy = measure("curtain", curtain);
        EXPECT_EQ(accuracy.right_side, 1.0);
        EXPECT_LT(accuracy.p95_deg, 3.5);
    }
}

TEST(Surface, WithoutStationsClosedAndOpenPassagesFaceTheirInside) {
    for (auto [name, shape] : {std::pair{"sphere", testing::make_sphere(30000, 2.0)},
                               std::pair{"tube", testing::make_tube(30000, 1.0, 6.0)},
                               std::pair{"room", testing::make_room(30000)}}) {
        testing::add_noise(shape, 0.003);
        SurfaceReport report;
        EXPECT_GT(measure(name, without_viewpoints(shape), &report).right_side, 0.99) << name;
        EXPECT_EQ(report.orientation, Orientation::kPropagation);
    }
}

TEST(Surface, WithoutStationsASmallThingFacesOutward) {
    // 20 cm across: nobody stood inside.
    Shape ball = testing::make_sphere(20000, 0.1);
    for (Vec3f& normal : ball.normals)
        normal = -normal;
    testing::add_noise(ball, 0.0003);
    SurfaceReport report;
    EXPECT_EQ(measure("ball", without_viewpoints(ball), &report).right_side, 1.0);
    EXPECT_EQ(report.facing_outside, report.surfels);
}

TEST(Surface, WithoutStationsABoxInARoomFacesTheRoom) {
    // A closed box on a wall of the room: seen alone, its inside looks like a passage, and where
    // it stands its walls meet the floor inside as they do outside.
    Shape shape = testing::make_room(60000);
    testing::Random random(3);
    for (int i = 0; i < 10000; ++i) {
        const int face = static_cast<int>(random.uniform(0.0, 5.0));
        Vec3d p{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)};
        Vec3d normal{};
        const int axis = face / 2;
        const double side = face % 2 ? -1.0 : 1.0;
        p[axis] = 0.3 * side;
        normal[axis] = side;
        testing::add_point(shape, p + Vec3d{0.1, 0.2, -0.7}, normal);
    }
    shape.area += 5 * 0.36;
    testing::add_noise(shape, 0.003);
    EXPECT_GT(measure("box in a room", without_viewpoints(shape)).right_side, 0.99);
}

TEST(Surface, WithoutStationsBothSidesOfACurtainFaceTheRoom) {
    Shape shape = testing::make_room(60000);
    const Shape curtain = testing::make_curtain(10000, 0.05);
    for (std::size_t i = 0; i < curtain.normals.size(); ++i) {
        const Vec3f p = curtain.cloud.points.positions[i] + Vec3f{-0.5f, 0.1f, 0.0f};
        testing::add_point(shape, vec3_cast<double>(p), vec3_cast<double>(curtain.normals[i]));
    }
    shape.area += 2.0;
    testing::add_noise(shape, 0.003);
    EXPECT_GT(measure("curtain in a room", without_viewpoints(shape)).right_side, 0.99);
}

TEST(Surface, GroundThatNothingEnclosesFacesUp) {
    Shape ground;
    ground.cloud.stations = {testing::station_at({}, false)};
    testing::Random random;
    for (int i = 0; i < 20000; ++i) {
        const double x = random.uniform(-5, 5), y = random.uniform(-5, 5);
        const double slope = 0.3 * std::cos(x);
        testing::add_point(ground, {x, y, 0.3 * std::sin(x)}, normalized(Vec3d{-slope, 0.0, 1.0}));
    }
    SurfaceReport report;
    EXPECT_EQ(measure("ground", without_viewpoints(ground), &report).right_side, 1.0);
    EXPECT_EQ(report.unsure_side, report.surfels);
}

TEST(Surface, PointsWithoutAStationFollowTheirNeighboursThatHaveOne) {
    // A wall has no inside: only the half that a station saw can say which side is free.
    Shape wall = testing::make_wall(10000, 2.0);
    wall.cloud.stations.push_back(testing::station_at({0, 0, 0}, false));
    for (std::size_t i = 0; i < wall.normals.size(); ++i) {
        wall.cloud.points.stations[i] = wall.cloud.points.positions[i].x > 1.0f;
    }
    SurfaceReport report;
    EXPECT_EQ(measure("half seen wall", wall, &report).right_side, 1.0);
    EXPECT_EQ(report.orientation, Orientation::kMixed);
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

TEST(Surface, BrokenAndDoubledPointsAreLeftOutAndCounted) {
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

TEST(Surface, CloudsWithoutASurfaceAreDegenerate) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    std::vector<Vec3f> line;
    for (int i = 0; i < 1000; ++i)
        line.push_back({static_cast<float>(i) * 0.01f, 0, 0});
    EXPECT_EQ(code_of(cloud_of({})), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of({{1, 2, 3}})), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of(std::vector<Vec3f>(1000, Vec3f{1, 2, 3}))), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of(std::vector<Vec3f>(10, Vec3f{kNaN, 0, 0}))), ExitCode::kDegenerate);
    EXPECT_EQ(code_of(cloud_of(line)), ExitCode::kDegenerate);
}

TEST(Surface, FourPointsMakeASurface) {
    const SurfelCloud cloud =
        make_surfels(cloud_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), {});
    ASSERT_EQ(cloud.surfels.size(), 4u);
    for (const Surfel& s : cloud.surfels)
        EXPECT_GT(s.normal.z, 0.999f);
}

TEST(Surface, DensityMayVaryAThousandfold) {
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

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/surface/surface.h"
#include "surface/accuracy.h"
#include "surface/measure.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

using testing::Accuracy;
using testing::measure;
using testing::Shape;
using testing::without_viewpoints;

TEST(SurfaceOrientation, BothSidesOfACurtainThinnerThanTheNeighbourhoodFaceTheirOwnStation) {
    for (const int n : {20000, 2000}) {  // neighbourhoods of 2 cm and of 7 cm
        Shape curtain = testing::make_curtain(n, 0.05);
        testing::add_noise(curtain, 0.003);
        const Accuracy accuracy = measure("curtain", curtain);
        EXPECT_EQ(accuracy.right_side, 1.0);
        EXPECT_LT(accuracy.p95_deg, 3.5);
    }
}

TEST(SurfaceOrientation, WithoutStationsClosedAndOpenPassagesFaceTheirInside) {
    for (auto [name, shape] : {std::pair{"sphere", testing::make_sphere(30000, 2.0)},
                               std::pair{"tube", testing::make_tube(30000, 1.0, 6.0)},
                               std::pair{"room", testing::make_room(30000)}}) {
        testing::add_noise(shape, 0.003);
        SurfaceReport report;
        EXPECT_GT(measure(name, without_viewpoints(shape), &report).right_side, 0.99) << name;
        EXPECT_EQ(report.orientation, Orientation::kPropagation);
    }
}

TEST(SurfaceOrientation, WithoutStationsASmallThingFacesOutward) {
    // 20 cm across: nobody stood inside.
    Shape ball = testing::make_sphere(20000, 0.1);
    for (Vec3f& normal : ball.normals)
        normal = -normal;
    testing::add_noise(ball, 0.0003);
    SurfaceReport report;
    EXPECT_EQ(measure("ball", without_viewpoints(ball), &report).right_side, 1.0);
    EXPECT_EQ(report.facing_outside, report.surfels);
}

TEST(SurfaceOrientation, WithoutStationsABoxInARoomFacesTheRoom) {
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

TEST(SurfaceOrientation, WithoutStationsBothSidesOfACurtainFaceTheRoom) {
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

TEST(SurfaceOrientation, GroundThatNothingEnclosesFacesUp) {
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

TEST(SurfaceOrientation, PointsWithoutAStationFollowTheirNeighboursThatHaveOne) {
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

}  // namespace
}  // namespace glowworm

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "surface/accuracy.h"
#include "surface/shapes.h"

// What stands free in a passage has two sides close together. Each stands in a room of 2 m, seen by
// a station in every corner and then by nobody known.

namespace glowworm {
namespace {

using testing::Accuracy;
using testing::Shape;

/// Adds a point that the station saw from which most rays come to it.
void add_seen(Shape& shape, const Vec3d& position, const Vec3d& normal) {
    std::uint32_t best = 0;
    double densest = 0.0;
    for (std::uint32_t s = 0; s < shape.cloud.stations.size(); ++s) {
        const Vec3d toward = shape.cloud.stations[s].position - position;
        const double distance = length(toward);
        const double rays = dot(toward, normal) / (distance * distance * distance);
        if (rays > densest) {
            densest = rays;
            best = s;
        }
    }
    testing::add_point(shape, position, normal, best);
}

/// A room with a station toward each of its eight corners, and what `add` puts in it.
Shape room_with(const std::function<void(Shape&, testing::Random&)>& add) {
    const Shape walls = testing::make_room(50000);
    Shape shape;
    for (int corner = 0; corner < 8; ++corner) {
        shape.cloud.stations.push_back(testing::station_at(
            {corner & 1 ? 0.85 : -0.85, corner & 2 ? 0.8 : -0.8, corner & 4 ? 0.75 : -0.75}));
    }
    for (std::size_t i = 0; i < walls.normals.size(); ++i) {
        add_seen(shape, vec3_cast<double>(walls.cloud.points.positions[i]),
                 vec3_cast<double>(walls.normals[i]));
    }
    testing::Random random(11);
    add(shape, random);
    testing::add_noise(shape, 0.003);
    return shape;
}

/// Share of the points beyond the room's own on their true side.
double right_side(const char* what, const Shape& shape) {
    SurfaceReport report;
    const SurfelCloud cloud = make_surfels(shape.cloud, {}, &report);
    const std::vector<Vec3f> truth = testing::truth_of(cloud.surfels, shape);
    std::vector<Surfel> surfels;
    std::vector<Vec3f> normals;
    for (std::size_t i = 0; i < cloud.surfels.size(); ++i) {
        const Vec3f& p = cloud.surfels[i].position;
        if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 0.97f) continue;
        surfels.push_back(cloud.surfels[i]);
        normals.push_back(truth[i]);
    }
    EXPECT_GT(surfels.size(), 3000u);
    const Accuracy accuracy = testing::compare(surfels, normals);
    testing::print(what, accuracy, report);
    return accuracy.right_side;
}

void expect_both_sides(const std::function<void(Shape&, testing::Random&)>& add) {
    Shape shape = room_with(add);
    EXPECT_GE(right_side("with stations", shape), 0.999);
    for (Station& station : shape.cloud.stations)
        station.has_viewpoint = false;
    shape.cloud.origin = {300.0, 200.0, 100.0};
    EXPECT_GE(right_side("without", shape), 0.99);
}

TEST(ThinThings, AColumnFacesTheRoomAllAround) {
    expect_both_sides([](Shape& shape, testing::Random& random) {
        for (int i = 0; i < 6000; ++i) {
            const double phi = random.uniform(0.0, 2.0 * std::numbers::pi);
            const Vec3d d{std::cos(phi), std::sin(phi), 0.0};
            add_seen(shape, d * 0.12 + Vec3d{0.2, -0.1, random.uniform(-1.0, 1.0)}, d);
        }
    });
}

TEST(ThinThings, BothSidesOfAFlakeFaceTheirOwn) {
    // A slab of rock of 60 cm by 80 cm that hangs half a metre off a wall and thins from 9 cm to 4.
    expect_both_sides([](Shape& shape, testing::Random& random) {
        constexpr double kSlope = 0.025 / 0.8;
        for (int i = 0; i < 12000; ++i) {
            const double side = i % 2 ? 1.0 : -1.0;
            const double down = random.uniform(0.0, 0.8);
            add_seen(shape,
                     {-0.5 + side * (0.045 - kSlope * down), random.uniform(-0.3, 0.3), 1.0 - down},
                     normalized(Vec3d{side, 0.0, -kSlope}));
        }
    });
}

/// Folded like cloth, from the ceiling down.
void add_curtain(Shape& shape, testing::Random& random, double thickness) {
    for (int i = 0; i < 16000; ++i) {
        const double side = i % 2 ? 1.0 : -1.0;
        const double x = random.uniform(-0.5, 0.5);
        const Vec3d normal = normalized(Vec3d{-0.5 * std::cos(10.0 * x), 1.0, 0.0}) * side;
        add_seen(shape,
                 Vec3d{x, 0.1 + 0.05 * std::sin(10.0 * x), random.uniform(0.0, 1.0)} +
                     normal * (thickness / 2.0),
                 normal);
    }
}

TEST(ThinThings, BothSidesOfAFoldedCurtainFaceTheirOwn) {
    expect_both_sides(
        [](Shape& shape, testing::Random& random) { add_curtain(shape, random, 0.05); });
}

TEST(ThinThings, StationsTellTheSidesOfACurtainAsThinAsThePointsAreApart) {
    const Shape room =
        room_with([](Shape& shape, testing::Random& random) { add_curtain(shape, random, 0.02); });
    EXPECT_GE(right_side("2 cm, with stations", room), 0.999);
}

}  // namespace
}  // namespace glowworm

#include "light_accuracy.h"

#include <gmock/gmock.h>

#include <cmath>
#include <iostream>

#include "octree/build.h"
#include "viewer/light/light_field.h"
#include "viewer/light/light_meter.h"

namespace glowworm {
namespace {

using ::testing::IsEmpty;

double percent(double share) {
    return 100.0 * share;
}

class LightOnSphere : public ::testing::TestWithParam<float> {};

TEST_P(LightOnSphere, SettlesAtTheFormulaWhereverTheLampStands) {
    const Context context = Context::headless();
    for (const double off_centre : {0.0, 1.2}) {
        const auto a = testing::sphere_accuracy(context, {}, 5, GetParam(), off_centre);
        std::cout << "albedo " << GetParam() << " lamp at " << off_centre << " m: mean error "
                  << percent(a.mean) << " %, rms " << percent(a.rms) << " %, worst "
                  << percent(a.worst) << " %, " << a.bounces << " bounces\n";
        EXPECT_TRUE(a.settled);
        EXPECT_LE(a.bounces, 5);
        EXPECT_LT(std::abs(a.mean), 1e-3);
        if (off_centre == 0.0) {
            EXPECT_LT(a.worst, 3e-3);
        }
    }
    EXPECT_THAT(context.errors(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Albedos, LightOnSphere, ::testing::Values(0.2f, 0.5f, 0.8f));

TEST(LightAccuracy, FewPointsLoseNoLight) {
    const Context context = Context::headless();
    for (const auto& [points_per_face, most] : {std::pair{0.5, 0.01}, {1.0, 0.003}}) {
        const auto a =
            testing::sphere_accuracy(context, {.links = 64}, 6, 0.8f, 1.2, points_per_face);
        std::cout << points_per_face << " points a face: mean error " << percent(a.mean)
                  << " %, rms " << percent(a.rms) << " %\n";
        EXPECT_LE(std::abs(a.mean), most);
    }
}

TEST(LightAccuracy, AWallThatEmitsLightsATurnedCubeAsFormFactorsSay) {
    const Context context = Context::headless();
    const testing::KnownLight cube = testing::known_cube(0.8, 1'000'000);
    const auto a = testing::cube_accuracy(context, {}, 6, cube);
    std::cout << "one bounce: bias " << percent(a.bias) << " %, nrms " << percent(a.nrms)
              << " %; settled, by wall:";
    for (const double wall : a.walls) {
        std::cout << ' ' << percent(wall);
        EXPECT_LE(std::abs(wall), 0.005);
    }
    std::cout << " %\n";
    EXPECT_LE(std::abs(a.bias), 0.005);
    EXPECT_LE(a.nrms, 0.015);
    EXPECT_LE(a.emitter, 1e-3);
}

TEST(LightAccuracy, LightGoesRoundTwoBends) {
    const Context context = Context::headless();
    const testing::KnownLight tunnel = testing::known_tunnel(0.8, 3'000'000);
    const auto errors = testing::tunnel_accuracy(context, {}, 7, tunnel);
    std::cout << "sections:";
    for (const double error : errors)
        std::cout << ' ' << percent(error);
    const int bounces = testing::bounces_to_far_end(context, {}, 6, tunnel);
    std::cout << " %; " << bounces << " bounces to 1 % at the far end\n";
    for (const double error : errors)
        EXPECT_LE(std::abs(error), 0.03);
    EXPECT_LE(bounces, 18);
}

TEST(LightAccuracy, ThinWallsKeepLightOut) {
    const Context context = Context::headless();
    for (const auto& [voxels, most] : {std::pair{1.0, 1e-3}, {2.0, 1e-4}}) {
        const auto leak = testing::wall_leak(context, {}, 6, voxels);
        std::cout << "wall of " << voxels << " voxels: " << percent(leak.lobes)
                  << " % on lobes, the meter reads " << percent(leak.meter) << " %\n";
        EXPECT_LE(leak.lobes, most);
        EXPECT_LE(leak.meter, most);
    }
}

TEST(LightAccuracy, GrazingLightIsNotShadowedByTheWallItGrazes) {
    const Context context = Context::headless();
    BuildSettings build;
    build.depth = 4;  // leaves of 26 cm: their planes lie up to 4 mm inside the sphere's wall
    const Octree octree = build_octree(testing::sphere(20000, 0.5f), build);
    Scene scene;
    const Vec3d lamp{1.9, 0.0, 0.0};
    scene.point_lights.push_back({"lamp", lamp, {10.0f, 10.0f, 10.0f}});
    LightField field(context, octree.view(), scene);
    std::vector<Probe> probes;
    for (const Surfel& surfel : testing::sphere(2000, 0.5f).surfels)
        probes.push_back({vec3_cast<double>(surfel.position), surfel.normal});
    const auto measured = measure_light(field, probes);
    double worst = 0.0;
    for (std::size_t i = 0; i < probes.size(); ++i) {
        const Vec3d way = lamp - probes[i].position;
        const double cosine = dot(normalized(way), vec3_cast<double>(probes[i].normal));
        const double truth = 10.0 * cosine / dot(way, way);
        worst = std::max(worst, std::abs(static_cast<double>(measured[i].direct.x) / truth - 1.0));
    }
    std::cout << "worst error of direct light " << percent(worst) << " %\n";
    EXPECT_LT(worst, 1e-4);
}

TEST(LightAccuracy, ConesComeNearTheFormulaAndThePapersOwnStayDarker) {
    const Context context = Context::headless();
    const auto corrected =
        testing::sphere_accuracy(context, {.gather = Gather::kCones, .cones = 6}, 5, 0.5f, 0.0);
    const auto faithful = testing::sphere_accuracy(context, {.faithful = true}, 5, 0.5f, 0.0);
    std::cout << "6 cones " << percent(corrected.mean) << " %, faithful " << percent(faithful.mean)
              << " %\n";
    EXPECT_LT(std::abs(corrected.mean), 0.05);
    EXPECT_GT(faithful.mean, -0.5);
    EXPECT_LT(faithful.mean, 0.1);
    EXPECT_THAT(context.errors(), IsEmpty());
}

}  // namespace
}  // namespace glowworm

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analytic_cave.h"
#include "octree/build.h"
#include "octree/error.h"
#include "viewer/app/default_scene.h"
#include "viewer/app/start.h"

namespace glowworm {
namespace {

/// Inside one of the dogleg's two legs by more than `margin` m.
bool in_passage(const Vec3d& p, double margin) {
    const auto within = [&](double v, double low, double high) {
        return v > low + margin && v < high - margin;
    };
    return within(p.z, 0, 1) &&
           ((within(p.x, 0, 4) && within(p.y, 0, 1)) || (within(p.x, 3, 4) && within(p.y, 0, 4)));
}

Octree cave_with(const std::vector<Station>& stations) {
    SurfelCloud cloud = testing::dogleg(0.06f);
    cloud.stations = stations;
    return build_octree(cloud, {.depth = 5});
}

TEST(DefaultScene, StandsAtTheStationAndLooksAlongThePassage) {
    const Octree octree = cave_with({{{0.4, 0.5, 0.6}, {0, 0, 0, 1}, true, "one"}});
    const Scene scene = default_scene(octree.view());
    ASSERT_EQ(scene.cameras.size(), 1u);
    const Camera& camera = scene.cameras[0];
    EXPECT_NEAR(length(camera.position - Vec3d{0.4, 0.5, 0.6}), 0.0, 1e-5);
    EXPECT_GT(normalized(camera.look_at - camera.position).x, 0.95) << "down the leg of 4 m";
    ASSERT_EQ(scene.point_lights.size(), 2u) << "one at the station, one on the helmet";
    EXPECT_EQ(scene.point_lights[1].name, "headlamp");
    for (const PointLight& lamp : scene.point_lights)
        EXPECT_TRUE(in_passage(lamp.position, 0.05));
}

TEST(DefaultScene, FindsAPlaceInsideWhereNoStationIsKnown) {
    for (const bool turned : {false, true}) {
        SurfelCloud cloud = testing::dogleg(0.06f);
        if (turned) {
            for (Surfel& surfel : cloud.surfels)
                surfel.normal = -surfel.normal;
        }
        const Octree octree = build_octree(cloud, {.depth = 5});
        const Scene scene = default_scene(octree.view());
        EXPECT_TRUE(in_passage(scene.cameras.at(0).position, 0.2)) << "normals turned: " << turned;
        for (const PointLight& lamp : scene.point_lights) {
            EXPECT_TRUE(in_passage(lamp.position, 0.02)) << lamp.name;
        }
    }
}

TEST(Start, RefusesAnUnknownCameraWithTheNamesThereAre) {
    const Octree octree = cave_with({});
    EXPECT_EQ(start_of(octree.view(), "", "").camera.name, "start");
    try {
        start_of(octree.view(), "", "cam7");
        ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        EXPECT_THAT(error.what(), ::testing::HasSubstr("start"));
    }
}

}  // namespace
}  // namespace glowworm

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "viewer/app/lamps.h"
#include "viewer/app/pace.h"

namespace glowworm {
namespace {

TEST(Pace, ShowsTheFirstPictureCoarselyAndAtOnce) {
    EXPECT_EQ(Pace().divisor(false), 8);
}

TEST(Pace, DrawsFullyWhereTheMachineIsFast) {
    Pace pace;
    pace.drawn(8, 0.0001);
    EXPECT_EQ(pace.divisor(true), 1);
}

TEST(Pace, KeepsMovementFluentAndRestSharp) {
    Pace pace;
    pace.drawn(8, 0.02);  // 1.28 s for all pixels
    EXPECT_EQ(pace.divisor(true), 4);
    EXPECT_EQ(pace.divisor(false), 1);
}

TEST(Pace, ForgetsASlowMomentWithinAFewFrames) {
    Pace pace;
    pace.drawn(1, 30.0);
    EXPECT_EQ(pace.divisor(true), 8);
    for (int i = 0; i < 12; ++i)
        pace.drawn(2, 0.01);
    EXPECT_EQ(pace.divisor(true), 1);
}

TEST(Lamps, AreSwitchedDimmedAndTintedOneByOne) {
    Scene scene;
    scene.point_lights.push_back({"a", {}, {1, 2, 4}});
    scene.spot_lights.push_back({"b", {}, {0, 0, 1}, 45, 0.1, {8, 8, 8}});
    scene.area_lights.push_back({"c", {}, {3, 3, 3}});
    std::vector<LampControl> lamps = lamp_controls(scene);
    ASSERT_EQ(lamps.size(), 3u);
    lamps[0].brightness = 0.5f;
    lamps[1].on = false;
    lamps[2].tint[1] = 0.0f;
    const Scene lit = controlled_scene(scene, lamps);
    EXPECT_EQ(lit.point_lights[0].radiant_intensity, (Vec3f{0.5f, 1, 2}));
    EXPECT_EQ(lit.spot_lights[0].radiant_intensity, (Vec3f{0, 0, 0}));
    EXPECT_EQ(lit.area_lights[0].radiance, (Vec3f{3, 0, 3}));
}

}  // namespace
}  // namespace glowworm

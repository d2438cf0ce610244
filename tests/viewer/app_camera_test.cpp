#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "viewer/app/fly_camera.h"

namespace glowworm {
namespace {

Camera northward() {
    Camera camera;
    camera.position = {1, 2, 3};
    camera.look_at = {1, 7, 3};
    return camera;
}

TEST(FlyCamera, StartsWhereTheCameraStands) {
    const Camera camera = FlyCamera(northward()).camera(640, 480);
    EXPECT_EQ(camera.position, (Vec3d{1, 2, 3}));
    EXPECT_NEAR(length(camera.look_at - Vec3d{1, 3, 3}), 0.0, 1e-12);
    EXPECT_EQ(camera.width, 640);
}

TEST(FlyCamera, FliesAlongItsLineOfSightAtItsSpeed) {
    FlyCamera fly(northward());
    fly.move({.ahead = 1}, 2.0);
    EXPECT_NEAR(length(fly.camera(1, 1).position - Vec3d{1, 2 + 2 * fly.speed(), 3}), 0.0, 1e-12);
    fly.move({.aside = 1, .rise = -1}, 1.0);
    const Vec3d expected = Vec3d{1, 2, 3} + Vec3d{1, 2, -1} * fly.speed();
    EXPECT_NEAR(length(fly.camera(1, 1).position - expected), 0.0, 1e-12) << "east is on the right";
}

TEST(FlyCamera, TurnsRightTowardTheRightAndNeverTipsOver) {
    FlyCamera fly(northward());
    fly.turn(M_PI / 2, 0);
    EXPECT_NEAR(length(fly.forward() - Vec3d{1, 0, 0}), 0.0, 1e-12) << "from north to east";
    fly.turn(0, 10.0);
    EXPECT_LT(fly.forward().z, 1.0) << "stops short of straight up";
    EXPECT_GT(fly.forward().x, 0.0);
}

TEST(FlyCamera, KeepsTheSpeedTheWheelSet) {
    FlyCamera fly(northward());
    const double before = fly.speed();
    fly.change_speed(2);
    EXPECT_NEAR(fly.speed(), before * 1.25 * 1.25, 1e-12);
    fly.move({.ahead = 1}, 5.0);
    EXPECT_NEAR(fly.speed(), before * 1.25 * 1.25, 1e-12);
}

}  // namespace
}  // namespace glowworm

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "camera_at.h"
#include "viewer/frame/view.h"

namespace glowworm {
namespace {

Camera tilted_camera() {
    return testing::camera_at({12.0, -3.0, 1.5}, {9.0, 4.0, 0.2}, 70.0, 400, 300);
}

TEST(View, LooksAtTheMiddleOfThePicture) {
    const Camera camera = tilted_camera();
    const PixelPoint middle = project(view_of(camera), camera.look_at);
    EXPECT_NEAR(middle.x, 200.0, 1e-9);
    EXPECT_NEAR(middle.y, 150.0, 1e-9);
    EXPECT_NEAR(middle.depth, length(camera.look_at - camera.position), 1e-9);
}

TEST(View, SpansTheVerticalFieldOfViewFromTopToBottom) {
    const View view = view_of(tilted_camera());
    const Vec3d top = ray_through(view, 200.0, 0.0).direction;
    const Vec3d bottom = ray_through(view, 200.0, 300.0).direction;
    const double angle = std::acos(dot(normalized(top), normalized(bottom)));
    EXPECT_NEAR(angle * 180.0 / M_PI, 70.0, 1e-9);
    EXPECT_GT(top.z, bottom.z) << "up is up";
}

TEST(View, HasTheWorldsRightOnTheRight) {
    Camera camera;
    camera.position = {0, 0, 0};
    camera.look_at = {0, 5, 0};  // north: east is on the right
    EXPECT_GT(project(view_of(camera), {1, 5, 0}).x, camera.width / 2.0);
    EXPECT_LT(project(view_of(camera), {0, 5, 1}).y, camera.height / 2.0);
}

TEST(View, ProjectsWhatARayPassesThroughToTheRaysPixel) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> x(0, 400), y(0, 300), depth(0.1, 50);
    for (const bool orthographic : {false, true}) {
        View view = view_of(tilted_camera());
        view.orthographic = orthographic;
        double worst = 0;
        for (int i = 0; i < 1000; ++i) {
            const double px = x(random), py = y(random), d = depth(random);
            const ViewRay ray = ray_through(view, px, py);
            const PixelPoint back = project(view, ray.origin + ray.direction * d);
            worst = std::max(
                {worst, std::abs(back.x - px), std::abs(back.y - py), std::abs(back.depth - d)});
        }
        EXPECT_LT(worst, 1e-9) << "orthographic " << orthographic;
    }
}

TEST(View, KeepsItsRaysInTilesAndSubPixels) {
    const View view = view_of(tilted_camera());
    const View tile = tile_of(view, 64, 32, 100, 80);
    const View fine = supersampled(view, 3);
    const Vec3d whole = ray_through(view, 74.5, 52.5).direction;
    EXPECT_NEAR(length(ray_through(tile, 10.5, 20.5).direction - whole), 0.0, 1e-12);
    EXPECT_NEAR(length(ray_through(fine, 223.5, 157.5).direction - whole), 0.0, 1e-12);
    EXPECT_EQ(tile.width, 100);
    EXPECT_EQ(fine.height, 900);
}

TEST(View, StaysFiniteWhenUpIsTheLineOfSight) {
    Camera camera;
    camera.position = {0, 0, 5};
    camera.look_at = {0, 0, 0};
    const View view = view_of(camera);
    EXPECT_NEAR(length(view.right), 1.0, 1e-12);
    EXPECT_NEAR(dot(view.right, view.forward), 0.0, 1e-12);
    EXPECT_NEAR(length(view.down - cross(view.forward, view.right)), 0.0, 1e-12);
}

}  // namespace
}  // namespace glowworm

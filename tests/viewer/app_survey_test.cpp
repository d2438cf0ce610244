// Survey views, mouse schemes and walking.
#include <cmath>

#include "analytic_cave.h"
#include "octree/build.h"
#include "testing.h"
#include "viewer/app/controls.h"
#include "viewer/app/navigator.h"
#include "viewer/app/survey_view.h"
#include "viewer/app/walk.h"

namespace glowworm {
namespace {

constexpr int kWidth = 400, kHeight = 300;

TEST(SurveyView, HasNorthAtTheTopOfAPlanAndEastOnItsRight) {
    const SurveyView plan = fitted_survey({{0, 0, 0}, {10, 4, 2}}, 0.0, -90.0, kWidth, kHeight);
    const View view = view_of(plan, kWidth, kHeight, 20.0);
    const PixelPoint middle = project(view, {5, 2, 1});
    EXPECT_NEAR(middle.x, kWidth / 2.0, 1e-9);
    EXPECT_NEAR(middle.y, kHeight / 2.0, 1e-9);
    const PixelPoint north = project(view, {5, 3, 1}), east = project(view, {6, 2, 1});
    EXPECT_LT(north.y, middle.y);
    EXPECT_NEAR(north.x, middle.x, 1e-9);
    EXPECT_GT(east.x, middle.x);
    EXPECT_NEAR(middle.y - north.y, 1.0 / plan.metres_per_pixel, 1e-6);
    EXPECT_NEAR(north_on_screen(view).down, -1.0, 1e-12);
    EXPECT_GT(project(view, {5, 2, 0}).depth, project(view, {5, 2, 2}).depth) << "from above";
}

TEST(SurveyView, HasUpAtTheTopOfAnElevationThatFacesItsBearing) {
    SurveyView facing_east = fitted_survey({{0, 0, 0}, {10, 4, 2}}, 90.0, 0.0, kWidth, kHeight);
    const View view = view_of(facing_east, kWidth, kHeight, 20.0);
    const PixelPoint middle = project(view, {5, 2, 1});
    EXPECT_LT(project(view, {5, 2, 2}).y, middle.y);
    EXPECT_LT(project(view, {5, 3, 1}).x, middle.x) << "north is on the left";
    EXPECT_GT(project(view, {6, 2, 1}).depth, middle.depth);
    EXPECT_NEAR(north_on_screen(view).right, -1.0, 1e-12);
}

TEST(SurveyView, ShowsTheWholeBoxFromEverySide) {
    const Vec3d low{-3, 5, -40}, high{12, 6, 2};
    for (const double tilt : {-90.0, -30.0, 0.0}) {
        for (double bearing = 0; bearing < 360; bearing += 45) {
            const SurveyView survey = fitted_survey({low, high}, bearing, tilt, kWidth, kHeight);
            const View view = view_of(survey, kWidth, kHeight, 100.0);
            for (int corner = 0; corner < 8; ++corner) {
                const PixelPoint p =
                    project(view, {corner & 1 ? low.x : high.x, corner & 2 ? low.y : high.y,
                                   corner & 4 ? low.z : high.z});
                EXPECT_TRUE(p.x > 0 && p.x < kWidth && p.y > 0 && p.y < kHeight && p.depth > 0);
            }
        }
    }
}

TEST(SurveyView, KeepsWhatIsUnderTheCursorWhenItZoomsOrPans) {
    SurveyView survey = fitted_survey({{0, 0, 0}, {10, 4, 2}}, 30.0, -60.0, kWidth, kHeight);
    const Vec3d point{7, 3, 1.5};
    const PixelPoint before = project(view_of(survey, kWidth, kHeight, 20.0), point);
    zoom(survey, 0.4, before.x - kWidth / 2.0, before.y - kHeight / 2.0);
    PixelPoint after = project(view_of(survey, kWidth, kHeight, 20.0), point);
    EXPECT_NEAR(after.x, before.x, 1e-9);
    EXPECT_NEAR(after.y, before.y, 1e-9);
    pan(survey, 13, -7);
    after = project(view_of(survey, kWidth, kHeight, 20.0), point);
    EXPECT_NEAR(after.x, before.x + 13, 1e-9);
    EXPECT_NEAR(after.y, before.y - 7, 1e-9);
}

TEST(SurveyView, ShowsTheSameInACoarserPicture) {
    const Octree room =
        build_octree(testing::closed_room({0, 0, 0}, {4, 4, 3}, 0.2f), {.depth = 3});
    Navigator navigator(room.view(), Camera{}, ControlScheme::kAven);
    navigator.set_screen_height(kHeight);
    navigator.show_survey(-90.0, kWidth, kHeight);
    const PixelPoint fine = project(navigator.view(kWidth, kHeight), {4, 3, 1});
    const PixelPoint coarse = project(navigator.view(kWidth / 4, kHeight / 4), {4, 3, 1});
    EXPECT_NEAR(coarse.x * 4, fine.x, 1e-9);
    EXPECT_NEAR(coarse.y * 4, fine.y, 1e-9);
}

TEST(SurveyView, PutsARoundNumberOnItsScaleBar) {
    EXPECT_NEAR(scale_bar_length(0.01, 200), 2.0, 1e-12);
    EXPECT_NEAR(scale_bar_length(0.01, 199), 1.0, 1e-12);
    EXPECT_NEAR(scale_bar_length(0.03, 200), 5.0, 1e-12);
    EXPECT_NEAR(scale_bar_length(0.0004, 200), 0.05, 1e-12);
    EXPECT_EQ(scale_bar_length(0.0, 200), 0.0);
}

TEST(FlyCamera, KeepsThePointItOrbitsAndComesNearerToInPlaceInThePicture) {
    Camera start;
    start.position = {1, 2, 3};
    start.look_at = {4, 6, 3.5};
    FlyCamera camera(start);
    const Vec3d pivot{3, 7, 2};
    const auto seen = [&] { return project(view_of(camera.camera(kWidth, kHeight)), pivot); };
    const PixelPoint before = seen();
    camera.orbit(pivot, 0.7, -0.2);
    EXPECT_NEAR(seen().x, before.x, 1e-6);
    EXPECT_NEAR(seen().y, before.y, 1e-6);
    EXPECT_NEAR(seen().depth, before.depth, 1e-9);
    camera.dolly(pivot, 0.5);
    EXPECT_NEAR(seen().x, before.x, 1e-6);
    EXPECT_NEAR(seen().depth, before.depth / 2, 1e-9);
    const double metre = view_of(camera.camera(kWidth, kHeight)).focal / seen().depth;
    camera.pan(0.1, 0.2);
    EXPECT_NEAR(seen().x, before.x - 0.1 * metre, 1e-6);
    EXPECT_NEAR(seen().y, before.y + 0.2 * metre, 1e-6);
}

TEST(FlyCamera, FacesTheWaysOfTheCompass) {
    FlyCamera camera{Camera{}};
    for (const double bearing : {0.0, 90.0, 180.0, 270.0}) {
        camera.face(bearing);
        EXPECT_NEAR(camera.forward().x, std::sin(bearing * M_PI / 180), 1e-12);
        EXPECT_NEAR(camera.forward().y, std::cos(bearing * M_PI / 180), 1e-12);
        EXPECT_NEAR(std::remainder(camera.bearing_deg() - bearing, 360.0), 0.0, 1e-9);
    }
}

TEST(Controls, DoWhatUsersOfOtherProgramsExpect) {
    using enum DragAction;
    using enum MouseButton;
    const auto action = [](ControlScheme scheme, MoveMode mode, MouseButton button,
                           bool shift = false) { return drag_action(scheme, mode, button, shift); };
    EXPECT_EQ(action(ControlScheme::kFly, MoveMode::kFly, kLeft), kLook);
    EXPECT_EQ(action(ControlScheme::kFly, MoveMode::kFly, kRight), kOrbit);
    EXPECT_EQ(action(ControlScheme::kPotree, MoveMode::kOrbit, kLeft), kOrbit);
    EXPECT_EQ(action(ControlScheme::kPotree, MoveMode::kOrbit, kRight), kPan);
    EXPECT_EQ(action(ControlScheme::kAven, MoveMode::kSurvey, kLeft), kTurnZoom);
    EXPECT_EQ(action(ControlScheme::kAven, MoveMode::kSurvey, kRight), kPan);
    EXPECT_EQ(action(ControlScheme::kAven, MoveMode::kSurvey, kMiddle), kTilt);
    EXPECT_EQ(action(ControlScheme::kCad, MoveMode::kOrbit, kLeft), kNone);
    EXPECT_EQ(action(ControlScheme::kCad, MoveMode::kOrbit, kMiddle), kOrbit);
    EXPECT_EQ(action(ControlScheme::kCad, MoveMode::kOrbit, kMiddle, true), kPan);
    EXPECT_EQ(wheel_action(ControlScheme::kFly, MoveMode::kFly), WheelAction::kSpeed);
    EXPECT_EQ(wheel_action(ControlScheme::kPotree, MoveMode::kOrbit), WheelAction::kDolly);
}

TEST(Walk, StoopsWhereTheCeilingIsLow) {
    EXPECT_NEAR(eye_height(10.0), kHeadHeight, 1e-12);
    EXPECT_NEAR(eye_height(1.0), 0.85, 1e-12);
    EXPECT_GT(eye_height(0.2), 0.0);
    EXPECT_LT(eye_height(0.2), 0.2);
    EXPECT_NEAR(stepped_height(3.0, 1.0, 0.0), 3.0, 1e-12);
    EXPECT_NEAR(stepped_height(3.0, 1.0, 10.0), 1.0, 1e-9);
}

TEST(Walk, StandsAtHeadHeightOverTheFloorOfARoomAndStaysThere) {
    const Octree room =
        build_octree(testing::closed_room({0, 0, 0}, {4, 4, 3}, 0.05f), {.depth = 5});
    const auto height = walking_height(room.view(), {2, 2, 2.2});
    ASSERT_TRUE(height);
    EXPECT_NEAR(*height, kHeadHeight, 0.02);
    EXPECT_FALSE(walking_height(room.view(), {2, 2, -5})) << "nothing beneath";

    Camera start;
    start.position = {2, 2, 2.5};
    start.look_at = {3, 2, 2.5};
    const OctreeView view = room.view();
    Navigator walker(view, start, ControlScheme::kFly);
    walker.set_mode(MoveMode::kWalk);
    for (int i = 0; i < 100; ++i)
        walker.step({.ahead = i < 20 ? 1.0 : 0.0}, 0.02);
    EXPECT_NEAR(walker.camera().position().z, kHeadHeight, 0.02);
    EXPECT_GT(walker.camera().position().x, 2.3);
    EXPECT_FALSE(walker.step({}, 0.02)) << "at rest nothing needs to be drawn";
}

}  // namespace
}  // namespace glowworm

#include "viewer/app/input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

namespace glowworm {
namespace {

constexpr double kReach = 4.0;

template <typename T>
const T& at(const std::vector<InputEvent>& events, std::size_t i) {
    return std::get<T>(events.at(i));
}

TEST(Input, KeepsTheOrderInWhichThingsHappened) {
    Input input;
    input.press_key(GLFW_KEY_M, 0);
    input.move_cursor(10, 20);
    input.press_button(MouseButton::kLeft, false);
    input.release_button(MouseButton::kLeft, 0.0, kReach);
    input.press_key(GLFW_KEY_ESCAPE, 0);
    input.move_cursor(30, 40);
    input.turn_wheel(2.0);
    input.drop("scene.json");
    const auto events = input.take_events();
    ASSERT_EQ(events.size(), 7u);
    EXPECT_EQ(at<KeyPress>(events, 0).key, GLFW_KEY_M);
    EXPECT_EQ(at<DragBegin>(events, 1).x, 10);
    at<DragEnd>(events, 2);
    EXPECT_EQ(at<Click>(events, 3).y, 20);
    EXPECT_EQ(at<KeyPress>(events, 4).key, GLFW_KEY_ESCAPE);
    EXPECT_EQ(at<WheelTurn>(events, 5).x, 30) << "where the cursor was then";
    EXPECT_EQ(at<FileDrop>(events, 6).path, "scene.json");
    EXPECT_TRUE(input.take_events().empty());
}

TEST(Input, MakesOneMoveOfManyButNotAcrossWhatHappenedBetween) {
    Input input;
    input.press_button(MouseButton::kLeft, false);
    input.move_cursor(1, 0);
    input.move_cursor(3, 5);
    input.press_key(GLFW_KEY_H, 0);
    input.move_cursor(4, 5);
    const auto events = input.take_events();
    ASSERT_EQ(events.size(), 4u);
    EXPECT_EQ(at<DragMove>(events, 1).right, 3);
    EXPECT_EQ(at<DragMove>(events, 1).down, 5);
    EXPECT_EQ(at<DragMove>(events, 3).right, 1);
}

TEST(Input, TellsClicksDragsAndDoubleClicksApart) {
    Input input;
    const auto click = [&](double x, double seconds) {
        input.move_cursor(x, 0);
        input.press_button(MouseButton::kLeft, false);
        input.release_button(MouseButton::kLeft, seconds, kReach);
        const auto events = input.take_events();
        return at<Click>(events, events.size() - 1).twice;
    };
    EXPECT_FALSE(click(0, 0.0));
    EXPECT_TRUE(click(1, 0.2));
    EXPECT_FALSE(click(1, 0.3)) << "a third one begins anew";
    EXPECT_FALSE(click(50, 0.4)) << "elsewhere";
    EXPECT_FALSE(click(50, 2.0)) << "later";

    input.press_button(MouseButton::kLeft, false);
    input.move_cursor(60, 0);
    input.move_cursor(50, 0);
    input.release_button(MouseButton::kLeft, 5.0, kReach);
    const auto events = input.take_events();
    EXPECT_TRUE(std::holds_alternative<DragEnd>(events.back())) << "there and back is a drag";
}

TEST(Input, FliesByHeldKeysAndHalfAStepByATap) {
    Input input;
    input.press_key(GLFW_KEY_W, 0);
    EXPECT_EQ(input.take_flight().ahead, 1.0);
    EXPECT_EQ(input.take_flight().ahead, 1.0) << "still held";
    input.release_key(GLFW_KEY_W);
    input.take_flight();
    EXPECT_EQ(input.take_flight().ahead, 0.0);
    input.press_key(GLFW_KEY_A, 0);
    input.release_key(GLFW_KEY_A);
    EXPECT_EQ(input.take_flight().aside, -0.5) << "down and up within one slow frame";
    EXPECT_EQ(input.take_flight().aside, 0.0);
    input.press_key(GLFW_KEY_S, GLFW_MOD_CONTROL);
    EXPECT_EQ(input.take_flight().ahead, 0.0) << "Ctrl+S saves";
}

}  // namespace
}  // namespace glowworm

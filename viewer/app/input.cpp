#include "viewer/app/input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>
#include <utility>

namespace glowworm {
namespace {

constexpr double kDoubleClickSeconds = 0.4;
constexpr double kTapShare = 0.5;  // of the time since then: what a tap is expected to have lasted

}  // namespace

void Input::press_key(int key, int modifiers) {
    stirred_ = true;
    events_.push_back(KeyPress{key, modifiers});
    // With Shift or Control the letters are commands, also when that is let go of first.
    if ((modifiers & (GLFW_MOD_SHIFT | GLFW_MOD_CONTROL)) == 0) held_.insert(key);
}

void Input::release_key(int key) {
    stirred_ = true;
    if (held_.erase(key) > 0) released_.insert(key);
}

void Input::press_button(MouseButton button, bool shift) {
    stirred_ = true;
    if (dragging_) events_.push_back(DragEnd{});  // one at a time
    dragging_ = true;
    drag_button_ = button;
    moved_since_press_ = 0.0;
    events_.push_back(DragBegin{button, shift, cursor_x_, cursor_y_});
}

void Input::release_button(MouseButton button, double seconds, double reach) {
    stirred_ = true;
    if (!dragging_ || button != drag_button_) return;
    dragging_ = false;
    events_.push_back(DragEnd{});
    if (moved_since_press_ > reach) return;
    const bool twice = clicked_at_ >= 0.0 && seconds - clicked_at_ < kDoubleClickSeconds &&
                       std::hypot(cursor_x_ - clicked_x_, cursor_y_ - clicked_y_) < 2 * reach;
    events_.push_back(Click{button, cursor_x_, cursor_y_, twice});
    clicked_at_ = twice ? -1.0 : seconds;
    clicked_x_ = cursor_x_;
    clicked_y_ = cursor_y_;
}

void Input::move_cursor(double x, double y) {
    stirred_ = true;
    const double right = x - cursor_x_, down = y - cursor_y_;
    cursor_x_ = x;
    cursor_y_ = y;
    if (!dragging_) return;
    moved_since_press_ += std::hypot(right, down);
    // A mouse reports up to a thousand times a second: what follows one another is one movement.
    if (!events_.empty()) {
        if (auto* const move = std::get_if<DragMove>(&events_.back())) {
            *move = {x, y, move->right + right, move->down + down};
            return;
        }
    }
    events_.push_back(DragMove{x, y, right, down});
}

void Input::turn_wheel(double notches) {
    stirred_ = true;
    events_.push_back(WheelTurn{notches, cursor_x_, cursor_y_});
}

void Input::drop(const std::filesystem::path& path) {
    stirred_ = true;
    events_.push_back(FileDrop{path});
}

std::vector<InputEvent> Input::take_events() {
    return std::exchange(events_, {});
}

bool Input::take_damage() {
    return std::exchange(damaged_, false);
}

bool Input::take_stir() {
    return std::exchange(stirred_, false);
}

FlyInput Input::take_flight() {
    const std::set<int> released = std::exchange(released_, {});
    const auto share = [&](int key) {
        return held_.contains(key) ? 1.0 : released.contains(key) ? kTapShare : 0.0;
    };
    return {.ahead = share(GLFW_KEY_W) - share(GLFW_KEY_S),
            .aside = share(GLFW_KEY_D) - share(GLFW_KEY_A),
            .rise = share(GLFW_KEY_R) - share(GLFW_KEY_F)};
}

}  // namespace glowworm

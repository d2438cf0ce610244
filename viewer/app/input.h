#pragma once

#include <filesystem>
#include <set>
#include <variant>
#include <vector>

#include "viewer/app/controls.h"
#include "viewer/app/fly_camera.h"

namespace glowworm {

// What a user does. Places are screen units from the window's upper left corner, right and down.

/// A key that went down, with what was held: GLFW_KEY_* and GLFW_MOD_*.
struct KeyPress {
    int key = 0, modifiers = 0;
};

/// A mouse button that went down.
struct DragBegin {
    MouseButton button = MouseButton::kLeft;
    bool shift = false;
    double x = 0.0, y = 0.0;
};

/// The mouse, moved with that button down: where it is, and how far from where it was.
struct DragMove {
    double x = 0.0, y = 0.0;
    double right = 0.0, down = 0.0;
};

struct DragEnd {};

/// A button that went down and up again in one place.
struct Click {
    MouseButton button = MouseButton::kLeft;
    double x = 0.0, y = 0.0;
    bool twice = false;  ///< the second of a double click
};

struct WheelTurn {
    double notches = 0.0;  ///< away from the user positive
    double x = 0.0, y = 0.0;
};

/// A file that was dropped on the window.
struct FileDrop {
    std::filesystem::path path;
};

using InputEvent = std::variant<KeyPress, DragBegin, DragMove, DragEnd, Click, WheelTurn, FileDrop>;

/// Makes events, in the order in which things happened, of what a window system reports.
class Input {
  public:
    void press_key(int key, int modifiers);
    void release_key(int key);
    void press_button(MouseButton button, bool shift);
    /// `seconds` of any clock that goes on; `reach`: screen units that a click may stray.
    void release_button(MouseButton button, double seconds, double reach);
    void move_cursor(double x, double y);
    void turn_wheel(double notches);
    void drop(const std::filesystem::path& path);
    /// The window was resized or uncovered.
    void damage() { damaged_ = stirred_ = true; }

    /// What happened since this was last asked for.
    std::vector<InputEvent> take_events();
    bool take_damage();
    /// Whether anything at all was done, a mere movement of the mouse included.
    bool take_stir();
    /// Which way the keys of movement held since this was last asked for would fly. One that went
    /// up again meanwhile counts half.
    FlyInput take_flight();

    double cursor_x() const { return cursor_x_; }
    double cursor_y() const { return cursor_y_; }
    bool dragging() const { return dragging_; }

  private:
    std::vector<InputEvent> events_;
    std::set<int> held_;      // went down without Shift or Control and are down still
    std::set<int> released_;  // were, and went up since take_flight()
    bool damaged_ = true, stirred_ = true;
    double cursor_x_ = 0.0, cursor_y_ = 0.0;

    bool dragging_ = false;
    MouseButton drag_button_ = MouseButton::kLeft;
    double moved_since_press_ = 0.0;
    double clicked_at_ = -1.0;  // s; negative: no click that another could double
    double clicked_x_ = 0.0, clicked_y_ = 0.0;
};

}  // namespace glowworm

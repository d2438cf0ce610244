#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "viewer/app/controls.h"
#include "viewer/app/fly_camera.h"

struct GLFWwindow;

namespace glowworm {

struct WindowExtent {
    int width = 0, height = 0;
    bool operator==(const WindowExtent&) const = default;
};

/// A key that went down, with what was held: GLFW_KEY_* and GLFW_MOD_*.
struct KeyPress {
    int key = 0, modifiers = 0;
};

/// A button that went down and up again in one place.
struct Click {
    MouseButton button = MouseButton::kLeft;
    double x = 0.0, y = 0.0;  ///< screen units, as cursor_x
    bool twice = false;       ///< the second of a double click
};

/// What the user did since the last frame.
struct Input {
    std::vector<KeyPress> pressed;  ///< in order
    std::set<int> held;             ///< went down without Shift or Control and are down still
    std::vector<Click> clicks;
    std::vector<std::filesystem::path> dropped;  ///< files on the window
    double wheel = 0.0;                          ///< notches, away from the user positive
    bool damaged = true;                         ///< the window was resized or uncovered

    bool drag_began = false, drag_ended = false;
    bool dragging = false;
    MouseButton drag_button = MouseButton::kLeft;
    bool drag_shift = false;
    double drag_from_x = 0.0, drag_from_y = 0.0;  ///< where the button went down
    double drag_x = 0.0, drag_y = 0.0;            ///< moved since the last frame, right and down

    double cursor_x = 0.0, cursor_y = 0.0;  ///< screen units from the window's upper left corner
    double moved_since_press = 0.0;
    double clicked_at = -1.0;  ///< s
    double clicked_x = 0.0, clicked_y = 0.0;
};

/// GLFW and its one window, its OpenGL 4.5 context current on this thread.
class GlfwWindow {
  public:
    /// Throws Error (kInternal) where there is no display, or none with OpenGL 4.5.
    GlfwWindow(const std::string& title, int width, int height);
    ~GlfwWindow();
    GlfwWindow(const GlfwWindow&) = delete;
    GlfwWindow& operator=(const GlfwWindow&) = delete;

    GLFWwindow* get() const { return window_; }
    bool should_close() const;
    void close();
    void swap();                       ///< shows what was drawn
    WindowExtent framebuffer() const;  ///< pixels; 0 x 0 where minimised
    WindowExtent screen() const;       ///< screen units, which the cursor is measured in

    /// Takes what happened since the last call; waits for it, at most `wait_seconds`.
    void poll(double wait_seconds);
    Input& input() { return input_; }
    /// Forgets what happened, when it has been dealt with.
    void clear_input();
    FlyInput held_keys() const;

  private:
    GLFWwindow* window_ = nullptr;
    Input input_;
};

}  // namespace glowworm

#pragma once

#include <optional>
#include <string>

#include "viewer/app/input.h"

struct GLFWwindow;

namespace glowworm {

struct WindowExtent {
    int width = 0, height = 0;
    bool operator==(const WindowExtent&) const = default;
};

/// GLFW and its one window, its OpenGL 4.5 context current on this thread.
class GlfwWindow {
  public:
    /// Without an extent a size that suits the screen. Throws Error (kInternal) where there is no
    /// display, or none with OpenGL 4.5.
    GlfwWindow(const std::string& title, std::optional<WindowExtent> extent);
    ~GlfwWindow();
    GlfwWindow(const GlfwWindow&) = delete;
    GlfwWindow& operator=(const GlfwWindow&) = delete;

    GLFWwindow* get() const { return window_; }
    bool should_close() const;
    void close();
    void swap();                       ///< shows what was drawn
    WindowExtent framebuffer() const;  ///< pixels; 0 x 0 where minimised
    WindowExtent screen() const;       ///< screen units, which the cursor is measured in
    /// How many screen units are as long as one on an ordinary screen: 2 on one that is twice as
    /// dense, but 1 where the window system sees to that itself.
    float units_scale() const;
    /// Whether the driver has lost the context (reset, sleep, another card): nothing of it is left.
    bool context_lost() const;

    /// Takes what happened since the last call; waits for it, at most `wait_seconds`.
    void poll(double wait_seconds);
    Input& input() { return input_; }

  private:
    GLFWwindow* window_ = nullptr;
    Input input_;
};

}  // namespace glowworm

#include "viewer/app/glfw_window.h"

// epoxy before GLFW, as it replaces the GL headers.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <cmath>

#include "octree/error.h"

namespace glowworm {
namespace {

constexpr double kClickReach = 4.0;  // screen units: what moves farther is a drag
constexpr double kDoubleClickSeconds = 0.4;

Input& input_of(GLFWwindow* window) {
    return *static_cast<Input*>(glfwGetWindowUserPointer(window));
}

void on_key(GLFWwindow* window, int key, int, int action, int modifiers) {
    Input& in = input_of(window);
    if (action == GLFW_RELEASE) in.held.erase(key);
    if (action != GLFW_PRESS) return;
    in.pressed.push_back({key, modifiers});
    // With Shift or Control the letters are commands, also when that is let go of first.
    if ((modifiers & (GLFW_MOD_SHIFT | GLFW_MOD_CONTROL)) == 0) in.held.insert(key);
}

void on_button(GLFWwindow* window, int button, int action, int modifiers) {
    if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    Input& in = input_of(window);
    const auto which = static_cast<MouseButton>(button);
    if (action == GLFW_PRESS) {
        in.dragging = in.drag_began = true;
        in.drag_button = which;
        in.drag_shift = (modifiers & GLFW_MOD_SHIFT) != 0;
        in.drag_from_x = in.cursor_x;
        in.drag_from_y = in.cursor_y;
        in.moved_since_press = 0.0;
        return;
    }
    if (!in.dragging || which != in.drag_button) return;
    in.dragging = false;
    in.drag_ended = true;
    if (in.moved_since_press > kClickReach) return;
    const double now = glfwGetTime();
    const bool twice =
        now - in.clicked_at < kDoubleClickSeconds &&
        std::hypot(in.cursor_x - in.clicked_x, in.cursor_y - in.clicked_y) < 2 * kClickReach;
    in.clicks.push_back({which, in.cursor_x, in.cursor_y, twice});
    in.clicked_at = twice ? -1.0 : now;
    in.clicked_x = in.cursor_x;
    in.clicked_y = in.cursor_y;
}

void on_cursor(GLFWwindow* window, double x, double y) {
    Input& in = input_of(window);
    if (in.dragging) {
        in.drag_x += x - in.cursor_x;
        in.drag_y += y - in.cursor_y;
        in.moved_since_press += std::hypot(x - in.cursor_x, y - in.cursor_y);
    }
    in.cursor_x = x;
    in.cursor_y = y;
}

}  // namespace

GlfwWindow::GlfwWindow(const std::string& title, int width, int height) {
    if (glfwInit() != GLFW_TRUE) {
        throw Error(ExitCode::kInternal,
                    "there is no display to open a window on; --headless renders without one");
    }
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        glfwTerminate();
        throw Error(ExitCode::kInternal,
                    "this display offers no OpenGL 4.5; --headless renders without it");
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);

    glfwSetWindowUserPointer(window_, &input_);
    glfwSetKeyCallback(window_, on_key);
    glfwSetMouseButtonCallback(window_, on_button);
    glfwSetCursorPosCallback(window_, on_cursor);
    glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double y) { input_of(w).wheel += y; });
    glfwSetFramebufferSizeCallback(window_,
                                   [](GLFWwindow* w, int, int) { input_of(w).damaged = true; });
    glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { input_of(w).damaged = true; });
    glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
        for (int i = 0; i < count; ++i)
            input_of(w).dropped.emplace_back(paths[i]);
    });
}

GlfwWindow::~GlfwWindow() {
    glfwTerminate();
}

bool GlfwWindow::should_close() const {
    return glfwWindowShouldClose(window_) != 0;
}

void GlfwWindow::close() {
    glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

void GlfwWindow::swap() {
    glfwSwapBuffers(window_);
}

WindowExtent GlfwWindow::framebuffer() const {
    WindowExtent extent;
    glfwGetFramebufferSize(window_, &extent.width, &extent.height);
    return extent;
}

WindowExtent GlfwWindow::screen() const {
    WindowExtent extent;
    glfwGetWindowSize(window_, &extent.width, &extent.height);
    return extent;
}

void GlfwWindow::poll(double wait_seconds) {
    if (wait_seconds > 0) {
        glfwWaitEventsTimeout(wait_seconds);
    } else {
        glfwPollEvents();
    }
}

void GlfwWindow::clear_input() {
    input_.pressed.clear();
    input_.clicks.clear();
    input_.dropped.clear();
    input_.wheel = input_.drag_x = input_.drag_y = 0.0;
    input_.damaged = input_.drag_began = input_.drag_ended = false;
}

FlyInput GlfwWindow::held_keys() const {
    const auto held = [&](int key) { return input_.held.contains(key) ? 1.0 : 0.0; };
    return {.ahead = held(GLFW_KEY_W) - held(GLFW_KEY_S),
            .aside = held(GLFW_KEY_D) - held(GLFW_KEY_A),
            .rise = held(GLFW_KEY_R) - held(GLFW_KEY_F)};
}

}  // namespace glowworm

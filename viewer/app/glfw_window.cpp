#include "viewer/app/glfw_window.h"

// epoxy before GLFW, as it replaces the GL headers.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <algorithm>

#include "octree/error.h"

namespace glowworm {
namespace {

constexpr WindowExtent kUsualExtent{1280, 800};
constexpr double kClickReach = 4.0;  // units of an ordinary screen: what moves farther is a drag

GlfwWindow& window_of(GLFWwindow* window) {
    return *static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window));
}

Input& input_of(GLFWwindow* window) {
    return window_of(window).input();
}

void on_key(GLFWwindow* window, int key, int, int action, int modifiers) {
    if (action == GLFW_PRESS) input_of(window).press_key(key, modifiers);
    if (action == GLFW_RELEASE) input_of(window).release_key(key);
}

void on_button(GLFWwindow* window, int button, int action, int modifiers) {
    if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    const auto which = static_cast<MouseButton>(button);
    if (action == GLFW_PRESS) {
        input_of(window).press_button(which, (modifiers & GLFW_MOD_SHIFT) != 0);
    } else {
        input_of(window).release_button(which, glfwGetTime(),
                                        kClickReach * double{window_of(window).units_scale()});
    }
}

void take_callbacks(GLFWwindow* window) {
    glfwSetKeyCallback(window, on_key);
    glfwSetMouseButtonCallback(window, on_button);
    glfwSetCursorPosCallback(
        window, [](GLFWwindow* w, double x, double y) { input_of(w).move_cursor(x, y); });
    glfwSetScrollCallback(window,
                          [](GLFWwindow* w, double, double y) { input_of(w).turn_wheel(y); });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { input_of(w).damage(); });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { input_of(w).damage(); });
    glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
        for (int i = 0; i < count; ++i)
            input_of(w).drop(paths[i]);
    });
}

}  // namespace

GlfwWindow::GlfwWindow(const std::string& title, std::optional<WindowExtent> extent) {
    if (glfwInit() != GLFW_TRUE) {
        throw Error(ExitCode::kInternal,
                    "there is no display to open a window on; --headless renders without one");
    }
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
    // A size that was asked for is of pixels.
    if (!extent) glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    const auto [width, height] = extent.value_or(kUsualExtent);
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        glfwTerminate();
        throw Error(ExitCode::kInternal,
                    "this display offers no OpenGL 4.5; --headless renders without it");
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    take_callbacks(window_);
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
    if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE) return extent;
    glfwGetFramebufferSize(window_, &extent.width, &extent.height);
    return extent;
}

WindowExtent GlfwWindow::screen() const {
    WindowExtent extent;
    glfwGetWindowSize(window_, &extent.width, &extent.height);
    return extent;
}

float GlfwWindow::units_scale() const {
    float scale = 1.0f, ignored = 1.0f;
    glfwGetWindowContentScale(window_, &scale, &ignored);
    const int pixels = framebuffer().width, units = screen().width;
    if (pixels > 0 && units > 0) scale *= static_cast<float>(units) / static_cast<float>(pixels);
    return std::clamp(scale, 0.5f, 8.0f);
}

bool GlfwWindow::context_lost() const {
    return glGetGraphicsResetStatus() != GL_NO_ERROR;
}

void GlfwWindow::poll(double wait_seconds) {
    if (wait_seconds > 0) {
        glfwWaitEventsTimeout(wait_seconds);
    } else {
        glfwPollEvents();
    }
}

}  // namespace glowworm

#include "viewer/app/input.h"

#include <GLFW/glfw3.h>

namespace glowworm {
namespace {

Input& input_of(GLFWwindow* window) {
    return *static_cast<Input*>(glfwGetWindowUserPointer(window));
}

}  // namespace

void listen(GLFWwindow* window, Input& input) {
    glfwSetWindowUserPointer(window, &input);
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
        if (action == GLFW_PRESS) input_of(w).pressed.push_back(key);
    });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) { input_of(w).wheel += y; });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int, int action, int) {
        input_of(w).dragging = action == GLFW_PRESS;
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
        Input& in = input_of(w);
        if (in.dragging) {
            in.drag_x += x - in.cursor_x;
            in.drag_y += y - in.cursor_y;
        }
        in.cursor_x = x;
        in.cursor_y = y;
    });
    glfwSetFramebufferSizeCallback(window,
                                   [](GLFWwindow* w, int, int) { input_of(w).damaged = true; });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { input_of(w).damaged = true; });
}

FlyInput held_keys(GLFWwindow* window) {
    const auto held = [&](int key) { return glfwGetKey(window, key) == GLFW_PRESS ? 1.0 : 0.0; };
    return {.ahead = held(GLFW_KEY_W) - held(GLFW_KEY_S),
            .aside = held(GLFW_KEY_D) - held(GLFW_KEY_A),
            .rise = held(GLFW_KEY_R) - held(GLFW_KEY_F)};
}

}  // namespace glowworm

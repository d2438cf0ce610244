#pragma once

#include <vector>

#include "viewer/app/fly_camera.h"

struct GLFWwindow;

namespace glowworm {

/// What the user did since the last frame. It must stay where it is while the window lives.
struct Input {
    std::vector<int> pressed;  ///< GLFW_KEY_*, in order
    double wheel = 0.0;        ///< notches, away from the user positive
    double drag_x = 0.0;       ///< pixels moved with a button held, right and down positive
    double drag_y = 0.0;
    bool damaged = true;  ///< the window was resized or uncovered

    double cursor_x = 0.0, cursor_y = 0.0;
    bool dragging = false;
};

/// Lets `window` report to `input`. Before other libraries install their callbacks: they pass on.
void listen(GLFWwindow* window, Input& input);

/// The keys that are held for flying.
FlyInput held_keys(GLFWwindow* window);

}  // namespace glowworm

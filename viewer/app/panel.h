#pragma once

#include <string>
#include <vector>

#include "viewer/app/lamps.h"
#include "viewer/frame/display.h"

struct GLFWwindow;

namespace glowworm {

/// What people read and change in the window.
struct PanelState {
    bool visible = true;
    bool show_keys = false;
    bool automatic_exposure = true;
    float exposure = 0.0f;  ///< stops
    ToneCurve curve = ToneCurve::kAgx;
    bool headlamp_on = true;
    float headlamp_intensity = 1.0f;  ///< W·sr⁻¹
    std::vector<LampControl> lamps;   ///< points, spots, areas, in the scene's order
    float speed = 1.5f;               ///< m/s

    std::string light_status;  ///< "tracing 40 %", "settled after 12 bounces"
    std::string message;       ///< the last thing that happened
    double frame_ms = 0.0;
    int divisor = 1;  ///< a frame pixel's edge in window pixels
};

/// Dear ImGui over a GLFW window.
class Panel {
  public:
    explicit Panel(GLFWwindow* window);
    ~Panel();
    Panel(const Panel&) = delete;
    Panel& operator=(const Panel&) = delete;

    /// Draws over the frame. Returns true when a lamp was changed.
    bool draw(PanelState& state);
    bool wants_mouse() const;
    bool wants_keyboard() const;
};

}  // namespace glowworm

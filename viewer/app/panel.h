#pragma once

#include "viewer/app/window_state.h"
#include "viewer/frame/view.h"

struct GLFWwindow;

namespace glowworm {

/// Dear ImGui over a GLFW window.
class Panel {
  public:
    /// Passes events on to the callbacks that the window has already.
    explicit Panel(GLFWwindow* window);
    ~Panel();
    Panel(const Panel&) = delete;
    Panel& operator=(const Panel&) = delete;

    /// Draws over the frame; `view` is what it shows, in screen units, `scale` times as large as on
    /// an ordinary screen.
    void draw(WindowState& state, const View& view, float scale);
    bool wants_mouse() const;
    bool wants_keyboard() const;
    bool is_editing() const;  ///< a value is held with the mouse or typed into

  private:
    void set_scale(float scale);

    float scale_ = 0.0f;  // that fonts and sizes are made for
    int height_ = 0;      // of the window, screen units
};

/// Screen units of what is so many pixels large on an ordinary screen.
float scaled(float pixels);

// The panel's sections.
void draw_picture_section(WindowState& state);
void draw_move_section(WindowState& state);
void draw_lamp_section(WindowState& state);
void draw_light_section(WindowState& state);
void draw_measure_section(WindowState& state);
void draw_path_section(WindowState& state);
void draw_statistics_section(WindowState& state);

/// What lies over the picture itself: handles, lines, the scale bar, the last message.
void draw_overlay(const WindowState& state, const View& view);

}  // namespace glowworm

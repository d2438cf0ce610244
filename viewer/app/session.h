#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "viewer/app/canvas.h"
#include "viewer/app/cave.h"
#include "viewer/app/glfw_window.h"
#include "viewer/app/history.h"
#include "viewer/app/live_light.h"
#include "viewer/app/navigator.h"
#include "viewer/app/options.h"
#include "viewer/app/pace.h"
#include "viewer/app/panel.h"
#include "viewer/app/pick.h"
#include "viewer/app/sharpening.h"
#include "viewer/app/start.h"
#include "viewer/app/window_state.h"

namespace glowworm {

/// An octree that is dropped on the window: the next to be looked at.
struct NextCave {
    std::filesystem::path path;
    Cave cave;
};

/// A window on one cave: takes what the user does, lets light propagate, draws. The cave and the
/// options must outlive it.
class Session {
  public:
    Session(const Options& options, const Cave& cave);

    /// Until the window is closed, or another cave is dropped on it, which is returned.
    std::optional<NextCave> run();

  private:
    /// What of the cave is drawn, and how.
    struct Surfaces {
        float pixels_between_points = 0.0f, wetness = 0.0f;
        bool clip = false;
        WorldBox clip_box;
        bool operator==(const Surfaces&) const = default;
    };
    /// What a picture looks like, beside what is in it.
    struct Look {
        Layer layer = Layer::kPicture;
        ToneCurve curve = ToneCurve::kAgx;
        bool automatic_exposure = true;
        float exposure = 0.0f;
        bool operator==(const Look&) const = default;
    };

    // session.cpp: drawing, and light that propagates meanwhile
    View view_of_size(int width, int height) const;
    Scene lit_scene() const;
    void relight_if_changed();
    void move_headlamp();
    bool draw_frame();
    bool sharpen(const WindowExtent& window);
    Surfaces surfaces() const;
    Look look() const;
    bool exposure_settled() const;
    void adapt_exposure(double seconds);
    void present(const WindowExtent& window);
    void show(double seconds);
    double resting_seconds() const;
    void moved();

    // session_input.cpp: the mouse, keys, tools
    void take_input(double seconds);
    void take_drag();
    void take_click(const Click& click);
    void use_tool(const SurfacePoint& point);
    void look_under_cursor();
    void play_path(double seconds);
    std::optional<SurfacePoint> pick(double x, double y);
    std::optional<SurfacePoint> pick_finely(double x, double y);
    std::optional<SurfacePoint> pick_in_tile(double x, double y);
    int lamp_at(double x, double y) const;

    // session_commands.cpp: what keys and panels ask for
    void carry_out(const Request& request);
    void add_lamp(int preset, const Vec3d& position, const Vec3d& direction);
    void choose_tool(Tool tool, MeasureKind kind = MeasureKind::kLeg);
    void finish_measuring();
    void step_history(bool back);
    void add_keyframe();
    void rebuild_light();

    // session_files.cpp
    Scene scene_to_save(int width, int height) const;
    void save_picture();
    void save_scene();
    void load_scene(const std::filesystem::path& path);
    void take_drop(const std::filesystem::path& path);
    void write_and_say(const std::filesystem::path& path, const std::string& text);

    const double opened_at_;
    const Options& options_;
    const Cave& cave_;
    Start start_;
    WindowState state_;
    History<std::vector<Lamp>> history_;
    GlfwWindow window_;
    Context context_;
    Navigator navigator_;
    Vec3d headlamp_eye_;
    LightSettings light_settings_;
    std::unique_ptr<LiveLight> light_;
    Frame frame_;
    Panel panel_;
    Display display_;
    Inspector inspector_;
    Canvas canvas_;
    Sharpening sharpening_;
    Look sharpened_as_;
    Surfaces drawn_as_;
    Pace pace_;
    WindowExtent paced_extent_;  // the window that it was learnt in
    std::optional<NextCave> next_;

    std::vector<Lamp> lit_lamps_;  // what the light was last computed for
    bool lit_headlamp_ = false;
    float lit_headlamp_intensity_ = 0.0f;
    Vec3d lit_eye_;
    View drawn_;                  // what the frame shows
    std::optional<Vec3d> pivot_;  // what a drag turns round
    std::optional<Vec3d> chosen_pivot_;
    int dragged_lamp_ = -1;  // none once the lamps are others

    int shown_ = 0;          // pictures
    double moved_at_ = 0.0;  // s, of now_seconds()
    double metered_at_ = 0.0;
    double relight_seconds_ = 0.0;  // how long the last one took
    double wanted_exposure_ = 0.0;
    bool stale_ = true;  // what is drawn is not what would be seen
    bool adapted_once_ = false;
};

/// Seconds of a clock that never goes back.
double now_seconds();

}  // namespace glowworm

#pragma once

#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "viewer/app/beginning.h"
#include "viewer/app/cave.h"
#include "viewer/app/damage_check.h"
#include "viewer/app/glfw_window.h"
#include "viewer/app/live_frame.h"
#include "viewer/app/live_light.h"
#include "viewer/app/panel.h"

namespace glowworm {

struct WindowClosed {};

/// An octree that is dropped on the window: the next to be looked at.
struct NextCave {
    std::filesystem::path path;
    Cave cave;
};

/// Why a session ended; a Beginning where its graphics context was lost: it goes on with that.
using SessionEnd = std::variant<WindowClosed, NextCave, Beginning>;

/// A window on one cave: takes what the user does, lets light propagate, draws. The cave and the
/// options must outlive it.
class Session {
  public:
    Session(const Options& options, const Cave& cave, Beginning beginning);

    SessionEnd run();

  private:
    // session.cpp: drawing, and light that propagates meanwhile
    bool goes_on() const;
    void step();
    bool draw();
    void look_for_damage();
    void look_for_cut();
    View view_of_size(int width, int height) const;
    Scene lit_scene() const;
    void relight_if_changed();
    void move_headlamp();
    void step_light();
    void begin_light();
    LightGround ground() const;
    void make_light(LightGround ground);
    void show(double seconds);
    double resting_seconds() const;
    void moved();
    void say(const std::string& sentence);

    // session_input.cpp: the mouse, keys, tools
    void take_input(double seconds);
    void take(const KeyPress& press);
    void take(const DragBegin& drag);
    void take(const DragMove& drag);
    void take(const DragEnd& drag);
    void take(const Click& click);
    void take(const WheelTurn& wheel);
    void take(const FileDrop& drop);
    void take_panel_values();
    void use_tool(const SurfacePoint& point);
    void look_under_cursor();
    void play_path(double seconds);
    int lamp_at(double x, double y) const;

    // session_commands.cpp: what keys and panels ask for
    void carry_out(const Request& request);
    void set_mode(MoveMode mode);
    void face(double bearing_deg);
    void go_to_station(std::size_t which);
    void go_to_keyframe(std::size_t which);
    void add_lamp(int preset, const Vec3d& position, const Vec3d& direction);
    void remove_lamp();
    void choose_tool(Tool tool, MeasureKind kind = MeasureKind::kLeg);
    void finish_measuring();
    void step_history(bool back);
    void add_keyframe();
    void clip_here();
    void stop_or_close();

    // session_files.cpp
    Scene scene_to_save(int width, int height) const;
    void save_picture();
    void save_scene();
    void load_scene(const std::filesystem::path& path);
    void save_path();
    void write_and_say(const std::filesystem::path& path, const std::string& text);

    const double opened_at_;
    const Options& options_;
    const Cave& cave_;
    Scene scene_;  // what is not edited of it: cameras, other keys
    Camera start_camera_;
    WindowState state_;
    History<std::vector<Lamp>> history_;
    Navigator navigator_;
    GlfwWindow window_;
    Context context_;
    LiveFrame frame_;
    Panel panel_;
    std::unique_ptr<LiveLight> light_;  // none before the first picture, or where it does not fit
    bool light_wanted_ = true;
    std::optional<DamageCheck> damage_check_;
    bool intact_ = true;  // as far as was seen, no one cut the file
    std::optional<NextCave> next_;

    /// What light comes from.
    struct LitBy {
        std::vector<Lamp> lamps;
        bool headlamp = false;
        float headlamp_intensity = 0.0f;
        Vec3d headlamp_eye;
        bool operator==(const LitBy&) const = default;
    };
    LitBy lit_by() const;

    LitBy lit_by_;  // when light was last told
    Vec3d headlamp_eye_;
    std::optional<Vec3d> pivot_;  // what a drag turns round
    std::optional<Vec3d> chosen_pivot_;
    int dragged_lamp_ = -1;                  // none once the lamps are others
    DragAction action_ = DragAction::kNone;  // of the drag that goes on

    int shown_ = 0;  // pictures
    double stepped_at_;
    double longest_step_ = 0.0;  // s
    std::future<LightGround> ground_;
    double moved_at_ = 0.0;  // s, of now_seconds()
    double metered_at_ = 0.0;
    double stirred_at_ = 0.0;  // s: something was done or drawn
    bool idle_ = false;        // nothing changes until something is done
};

/// Seconds of a clock that never goes back.
double now_seconds();

}  // namespace glowworm

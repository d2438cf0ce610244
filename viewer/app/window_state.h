#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/app/camera_path.h"
#include "viewer/app/commands.h"
#include "viewer/app/lamps.h"
#include "viewer/app/measure.h"
#include "viewer/app/probes.h"
#include "viewer/frame/inspector.h"
#include "viewer/frame/view.h"
#include "viewer/light/settings.h"

namespace glowworm {

/// What the next click in the picture is for.
enum class Tool { kNone, kMeasure, kMeter, kPlaceLamp, kAimLamp };

/// What the light meter reads under the cursor.
struct LightReading {
    Vec3d position;
    Irradiance irradiance;
};

/// A place of the cave that has a name.
struct Mark {
    std::string name;
    Vec3d position;  ///< m, world
};

/// What people read and change in the window: panels show it and write into it, the session acts on
/// it.
struct WindowState {
    std::vector<Request> requests;  ///< of this frame, for the session
    std::string message;            ///< the last thing that happened, or went wrong
    bool visible = true;
    bool show_keys = false;

    // the picture
    bool automatic_exposure = true;
    float exposure = 0.0f;  ///< stops
    ToneCurve curve = ToneCurve::kAgx;
    Layer layer = Layer::kPicture;
    int level = 0;  ///< of the octree's `levels` that a layer of it shows
    int levels = 1;
    float wetness = 0.0f;
    float pixels_between_points = 0.7f;
    bool clip = false;  ///< only what lies in the box is drawn
    WorldBox clip_box;
    bool show_stations = false, show_lamps = true, show_path = true;

    // moving
    ControlScheme scheme = ControlScheme::kFly;
    MoveMode mode = MoveMode::kFly;
    float speed = 1.5f;  ///< m/s
    float vfov_deg = 65.0f;
    bool cut = false;      ///< a survey view's section
    float section = 0.0f;  ///< m before the survey's centre
    std::vector<Mark> stations;

    // light
    std::vector<Lamp> lamps;
    int selected = -1;  ///< lamp, -1: none
    bool headlamp_on = true;
    float headlamp_intensity = 1.0f;  ///< W·sr⁻¹
    int preset = 0;
    bool can_undo = false, can_redo = false;
    LightSettings light;
    bool limit_bounces = false;
    int bounces = 4;
    std::string light_status;      ///< "direct only", "settled after 12 bounces"
    std::vector<float> residuals;  ///< relative change by each step since the lamps changed
    std::string scene_file;

    // measuring
    Tool tool = Tool::kNone;
    Measurement open;  ///< being picked
    std::vector<Measurement> measurements;
    std::optional<Vec3d> under_cursor;
    double cursor_distance = 0.0;  ///< m from the eye
    std::optional<LightReading> reading;

    // the path
    CameraPath path{30.0, {}};
    bool playing = false;
    double play_time = 0.0;  ///< s

    // what it costs
    double frame_ms = 0.0;
    int divisor = 1;                   ///< a frame pixel's edge in window pixels
    double sharpened = 0.0;            ///< share of the window that was drawn finely since
    std::vector<float> frame_history;  ///< ms, the newest last
    bool measure_passes = false;
    std::vector<std::pair<std::string, double>> passes;  ///< ms
    std::uint64_t points_drawn = 0;
    std::uint64_t points_without_room = 0;  ///< of those wanted, in --gpu-memory
    std::string file_facts;
};

}  // namespace glowworm

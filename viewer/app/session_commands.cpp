// What keys and panels ask for.
#include <fmt/format.h>

#include <algorithm>

#include "viewer/app/session.h"

namespace glowworm {
namespace {

constexpr double kKeyframeSeconds = 2.0;  // from one keyframe to the next, until it is edited
constexpr double kLookAhead = 3.0;        // m: what a keyframe's camera looks at
constexpr double kClipReach = 2.0;        // m: from the middle of a new clip box to its sides
constexpr double kBesideEye = 0.2;        // m: a lamp that is put down is not in the eye

}  // namespace

void Session::carry_out(const Request& request) {
    const WindowExtent screen = window_.screen();
    const auto which = static_cast<std::size_t>(std::max(request.which, 0));
    state_.message.clear();
    switch (request.command) {
        case Command::kClose:
            return stop_or_close();
        case Command::kHidePanels:
            state_.visible = !state_.visible;
            return;
        case Command::kShowKeys:
            state_.show_keys = !state_.show_keys;
            return;
        case Command::kFly:
            return set_mode(MoveMode::kFly);
        case Command::kOrbit:
            return set_mode(MoveMode::kOrbit);
        case Command::kWalk:
            return set_mode(MoveMode::kWalk);
        case Command::kPlan:
            navigator_.show_survey(-90.0, screen.width, screen.height);
            return moved();
        case Command::kElevation:
            navigator_.show_survey(0.0, screen.width, screen.height);
            return moved();
        case Command::kFaceNorth:
            return face(0.0);
        case Command::kFaceEast:
            return face(90.0);
        case Command::kFaceSouth:
            return face(180.0);
        case Command::kFaceWest:
            return face(270.0);
        case Command::kRotate:
            return navigator_.toggle_rotation();
        case Command::kReset:
            navigator_.reset(screen.width, screen.height);
            return moved();
        case Command::kGoToStation:
            return go_to_station(which);
        case Command::kHeadlamp:
            state_.headlamp_on = !state_.headlamp_on;
            return;
        case Command::kAddLamp: {
            const FlyCamera& eye = navigator_.camera();
            const Vec3d beside = eye.position() + eye.right() * kBesideEye;
            return add_lamp(request.which, beside, eye.forward());
        }
        case Command::kPlaceLamp:
            state_.preset = request.which;
            return choose_tool(Tool::kPlaceLamp);
        case Command::kAimLamp:
            return choose_tool(Tool::kAimLamp);
        case Command::kRemoveLamp:
            return remove_lamp();
        case Command::kUndo:
            return step_history(true);
        case Command::kRedo:
            return step_history(false);
        case Command::kSaveScene:
            return save_scene();
        case Command::kLoadScene:
            return load_scene(state_.scene_file);
        case Command::kSavePicture:
            return save_picture();
        case Command::kMeasureLeg:
            return choose_tool(Tool::kMeasure, MeasureKind::kLeg);
        case Command::kMeasurePolyline:
            return choose_tool(Tool::kMeasure, MeasureKind::kPolyline);
        case Command::kMeasurePolygon:
            return choose_tool(Tool::kMeasure, MeasureKind::kPolygon);
        case Command::kMeterLight:
            return choose_tool(Tool::kMeter);
        case Command::kFinishMeasuring:
            return finish_measuring();
        case Command::kSaveMeasurements:
            return write_and_say("glowworm-measurements.json",
                                 measurements_json(state_.measurements));
        case Command::kAddKeyframe:
            return add_keyframe();
        case Command::kPlayPath:
            state_.playing = !state_.playing && !state_.path.keys.empty();
            if (state_.playing) state_.play_time = state_.path.keys.front().time;
            return;
        case Command::kSavePath:
            return save_path();
        case Command::kGoToKeyframe:
            return go_to_keyframe(which);
        case Command::kClipHere:
            return clip_here();
        case Command::kRebuildLight:
            light_wanted_ = true;
            return;
    }
}

/// Escape ends what is being done, and where nothing is the window.
void Session::stop_or_close() {
    if (state_.tool == Tool::kNone && !state_.playing) window_.close();
    state_.open.points.clear();
    state_.tool = Tool::kNone;
    state_.playing = false;
}

void Session::set_mode(MoveMode mode) {
    navigator_.set_mode(mode);
    moved();
}

void Session::face(double bearing_deg) {
    navigator_.face(bearing_deg);
    moved();
}

/// Looking the same way as before.
void Session::go_to_station(std::size_t which) {
    if (which >= state_.stations.size()) return;
    Camera camera = navigator_.camera().camera(1, 1);
    const Vec3d ahead = camera.look_at - camera.position;
    camera.position = state_.stations[which].position;
    camera.look_at = camera.position + ahead;
    navigator_.go_to(camera);
    moved();
}

void Session::go_to_keyframe(std::size_t which) {
    if (which >= state_.path.keys.size()) return;
    navigator_.go_to(camera_at_time(state_.path, state_.path.keys[which].time, Camera{}));
    moved();
}

/// In a survey view whatever lies above and below the middle.
void Session::clip_here() {
    const Vec3d reach{kClipReach, kClipReach, kClipReach};
    const Vec3d middle =
        navigator_.in_survey() ? navigator_.survey().centre : navigator_.camera().position();
    state_.clip_box = {middle - reach, middle + reach};
    if (navigator_.in_survey()) {
        state_.clip_box.low.z = navigator_.bounds().low.z;
        state_.clip_box.high.z = navigator_.bounds().high.z;
    }
    state_.clip = true;
}

void Session::add_lamp(int preset, const Vec3d& position, const Vec3d& direction) {
    const auto presets = lamp_presets();
    const auto which =
        static_cast<std::size_t>(std::clamp<int>(preset, 0, int(presets.size()) - 1));
    Lamp lamp = lamp_from(presets[which], position, direction);
    lamp.name = free_name(state_.lamps, lamp.name);
    // Area lights stay the last: the scene's order.
    const auto end = std::find_if(state_.lamps.begin(), state_.lamps.end(), [&](const Lamp& other) {
        return static_cast<int>(other.kind) > static_cast<int>(lamp.kind);
    });
    state_.selected = static_cast<int>(end - state_.lamps.begin());
    state_.lamps.insert(end, lamp);
    dragged_lamp_ = -1;
    say(fmt::format("added '{}'", lamp.name));
}

void Session::remove_lamp() {
    if (state_.selected < 0) return;
    if (state_.lamps[static_cast<std::size_t>(state_.selected)].kind == LampKind::kArea) {
        return say("area lights are part of the octree: switch it off instead");
    }
    state_.lamps.erase(state_.lamps.begin() + state_.selected);
    state_.selected = dragged_lamp_ = -1;
}

void Session::choose_tool(Tool tool, MeasureKind kind) {
    const bool again = state_.tool == tool && (tool != Tool::kMeasure || state_.open.kind == kind);
    state_.tool = again ? Tool::kNone : tool;
    state_.open = {kind, {}};
}

/// A line or polygon ends where another point would follow.
void Session::finish_measuring() {
    if (state_.tool != Tool::kMeasure) return;
    const std::size_t least = state_.open.kind == MeasureKind::kPolygon ? 3 : 2;
    if (state_.open.points.size() >= least) {
        say(measurement_text(state_.open));
        state_.measurements.push_back(state_.open);
    }
    state_.open.points.clear();
}

void Session::step_history(bool back) {
    state_.lamps = back ? history_.undo() : history_.redo();
    if (state_.selected >= static_cast<int>(state_.lamps.size())) state_.selected = -1;
    dragged_lamp_ = -1;
}

void Session::add_keyframe() {
    const FlyCamera& eye = navigator_.camera();
    std::vector<PathKey>& keys = state_.path.keys;
    PathKey key;
    key.time = keys.empty() ? 0.0 : keys.back().time + kKeyframeSeconds;
    key.position = eye.position();
    key.look_at = eye.position() + eye.forward() * kLookAhead;
    key.vfov_deg = eye.vfov_deg();
    keys.push_back(key);
    say(fmt::format("keyframe {} at {:.1f} s", keys.size(), key.time));
}

}  // namespace glowworm

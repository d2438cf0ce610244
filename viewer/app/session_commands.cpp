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
            if (state_.tool == Tool::kNone && !state_.playing) window_.close();
            state_.open.points.clear();
            state_.tool = Tool::kNone;
            state_.playing = false;
            break;
        case Command::kHidePanels:
            state_.visible = !state_.visible;
            break;
        case Command::kShowKeys:
            state_.show_keys = !state_.show_keys;
            break;
        case Command::kFly:
            navigator_.set_mode(MoveMode::kFly);
            moved();
            break;
        case Command::kOrbit:
            navigator_.set_mode(MoveMode::kOrbit);
            moved();
            break;
        case Command::kWalk:
            navigator_.set_mode(MoveMode::kWalk);
            moved();
            break;
        case Command::kPlan:
            navigator_.show_survey(-90.0, screen.width, screen.height);
            moved();
            break;
        case Command::kElevation:
            navigator_.show_survey(0.0, screen.width, screen.height);
            moved();
            break;
        case Command::kFaceNorth:
            navigator_.face(0.0);
            moved();
            break;
        case Command::kFaceEast:
            navigator_.face(90.0);
            moved();
            break;
        case Command::kFaceSouth:
            navigator_.face(180.0);
            moved();
            break;
        case Command::kFaceWest:
            navigator_.face(270.0);
            moved();
            break;
        case Command::kRotate:
            navigator_.toggle_rotation();
            break;
        case Command::kReset:
            navigator_.reset(screen.width, screen.height);
            moved();
            break;
        case Command::kGoToStation:
            if (which < state_.stations.size()) {
                Camera camera = navigator_.camera().camera(1, 1);
                const Vec3d ahead = camera.look_at - camera.position;
                camera.position = state_.stations[which].position;
                camera.look_at = camera.position + ahead;
                navigator_.go_to(camera);
                moved();
            }
            break;
        case Command::kHeadlamp:
            state_.headlamp_on = !state_.headlamp_on;
            break;
        case Command::kAddLamp: {
            const FlyCamera& eye = navigator_.camera();
            add_lamp(request.which, eye.position() + eye.right() * kBesideEye, eye.forward());
            break;
        }
        case Command::kPlaceLamp:
            state_.preset = request.which;
            choose_tool(Tool::kPlaceLamp);
            break;
        case Command::kAimLamp:
            choose_tool(Tool::kAimLamp);
            break;
        case Command::kRemoveLamp:
            if (state_.selected < 0) break;
            if (state_.lamps[static_cast<std::size_t>(state_.selected)].kind == LampKind::kArea) {
                state_.message = "area lights are part of the octree: switch it off instead";
                break;
            }
            state_.lamps.erase(state_.lamps.begin() + state_.selected);
            state_.selected = dragged_lamp_ = -1;
            break;
        case Command::kUndo:
            step_history(true);
            break;
        case Command::kRedo:
            step_history(false);
            break;
        case Command::kSaveScene:
            save_scene();
            break;
        case Command::kLoadScene:
            load_scene(state_.scene_file);
            break;
        case Command::kSavePicture:
            save_picture();
            break;
        case Command::kMeasureLeg:
            choose_tool(Tool::kMeasure, MeasureKind::kLeg);
            break;
        case Command::kMeasurePolyline:
            choose_tool(Tool::kMeasure, MeasureKind::kPolyline);
            break;
        case Command::kMeasurePolygon:
            choose_tool(Tool::kMeasure, MeasureKind::kPolygon);
            break;
        case Command::kMeterLight:
            choose_tool(Tool::kMeter);
            break;
        case Command::kFinishMeasuring:
            finish_measuring();
            break;
        case Command::kSaveMeasurements:
            write_and_say("glowworm-measurements.json", measurements_json(state_.measurements));
            break;
        case Command::kAddKeyframe:
            add_keyframe();
            break;
        case Command::kPlayPath:
            state_.playing = !state_.playing && !state_.path.keys.empty();
            if (state_.playing) state_.play_time = state_.path.keys.front().time;
            break;
        case Command::kSavePath:
            if (state_.path.keys.empty()) {
                state_.message = "the path has no keyframes yet: K adds one";
            } else {
                write_and_say("glowworm-path.json", camera_path_json(state_.path));
            }
            break;
        case Command::kGoToKeyframe:
            if (which < state_.path.keys.size()) {
                navigator_.go_to(
                    camera_at_time(state_.path, state_.path.keys[which].time, Camera{}));
                moved();
            }
            break;
        case Command::kClipHere: {
            const Vec3d reach{kClipReach, kClipReach, kClipReach};
            const Vec3d middle = navigator_.in_survey() ? navigator_.survey().centre
                                                        : navigator_.camera().position();
            state_.clip_box = {middle - reach, middle + reach};
            if (navigator_.in_survey()) {  // whatever lies above and below it
                state_.clip_box.low.z = navigator_.bounds().low.z;
                state_.clip_box.high.z = navigator_.bounds().high.z;
            }
            state_.clip = true;
            break;
        }
        case Command::kRebuildLight:
            rebuild_light();
            break;
    }
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
    state_.message = fmt::format("added '{}'", lamp.name);
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
        state_.message = measurement_text(state_.open);
        state_.measurements.push_back(state_.open);
    }
    state_.open.points.clear();
}

void Session::step_history(bool back) {
    state_.lamps = back ? history_.undo() : history_.redo();
    state_.selected = std::min(state_.selected, static_cast<int>(state_.lamps.size()) - 1);
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
    state_.message = fmt::format("keyframe {} at {:.1f} s", keys.size(), key.time);
}

/// Light as the settings say, from the beginning.
void Session::rebuild_light() {
    light_settings_ = state_.light;
    const auto bounces = state_.limit_bounces ? std::optional(state_.bounces) : std::nullopt;
    const Scene scene = lit_scene();
    light_.reset();
    light_ = std::make_unique<LiveLight>(context_, cave_.light(), scene, light_settings_, bounces);
    frame_.set_panels(scene.area_lights);
    lit_lamps_ = state_.lamps;
    lit_headlamp_ = state_.headlamp_on;
    lit_headlamp_intensity_ = state_.headlamp_intensity;
    lit_eye_ = headlamp_eye_;
    stale_ = true;
}

}  // namespace glowworm

// What the user does with mouse and keys.
#include <algorithm>
#include <cmath>

#include "viewer/app/session.h"
#include "viewer/light/light_meter.h"

namespace glowworm {
namespace {

constexpr double kHandleReach = 10.0;  // units of an ordinary screen, round a lamp's handle
constexpr double kOffWall = 0.15;      // m: a lamp on a wall hangs so far before it
constexpr double kMeterSeconds = 0.2;  // between two readings of the light meter

}  // namespace

/// A frame may take long: what happened meanwhile is taken one after the other.
void Session::take_input(double seconds) {
    Input& in = window_.input();
    if (window_.screen().height > 0) navigator_.set_screen_height(window_.screen().height);
    for (const InputEvent& event : in.take_events())
        std::visit([this](const auto& happened) { take(happened); }, event);
    for (const Request& request : std::exchange(state_.requests, {}))
        carry_out(request);
    take_panel_values();

    const FlyInput flown = in.take_flight();
    const FlyInput held = panel_.wants_keyboard() ? FlyInput{} : flown;
    if (held.ahead != 0 || held.aside != 0 || held.rise != 0) state_.playing = false;
    if (navigator_.step(held, seconds)) moved();
    play_path(seconds);
    look_under_cursor();
    if (in.take_damage()) frame_.spoil();
}

void Session::take(const KeyPress& press) {
    if (panel_.wants_keyboard()) return;
    const auto request = request_of_key(press.key, press.modifiers, navigator_.mode());
    if (request) carry_out(*request);
}

void Session::take(const DragBegin& drag) {
    if (panel_.wants_mouse()) return;
    const auto point = frame_.pick(drag.x, drag.y);
    pivot_ = point ? std::optional(point->position) : std::nullopt;
    const bool handles = drag.button == MouseButton::kLeft && !drag.shift && state_.show_lamps &&
                         state_.tool == Tool::kNone;
    dragged_lamp_ = handles ? lamp_at(drag.x, drag.y) : -1;
    if (dragged_lamp_ >= 0) state_.selected = dragged_lamp_;
    action_ = drag_action(navigator_.scheme(), navigator_.mode(), drag.button, drag.shift);
}

void Session::take(const DragMove& drag) {
    if (panel_.wants_mouse()) return;
    if (dragged_lamp_ >= 0 && dragged_lamp_ < static_cast<int>(state_.lamps.size())) {
        Lamp& lamp = state_.lamps[static_cast<std::size_t>(dragged_lamp_)];
        const auto wall = frame_.pick(drag.x, drag.y);
        if (wall && lamp.kind != LampKind::kArea) {
            lamp.position = wall->position + wall->normal * kOffWall;
        }
        return;
    }
    // Looking about takes no point; what was double-clicked is orbited until another is.
    const bool orbits = action_ == DragAction::kOrbit || action_ == DragAction::kTurnZoom;
    const WindowExtent screen = window_.screen();
    state_.playing = false;
    navigator_.drag(action_, drag.right, drag.down,
                    orbits && chosen_pivot_ ? chosen_pivot_ : pivot_,
                    view_of_size(screen.width, screen.height));
    moved();
}

void Session::take(const DragEnd&) {
    dragged_lamp_ = -1;
}

void Session::take(const Click& click) {
    if (panel_.wants_mouse() || click.button != MouseButton::kLeft) return;
    const bool picks = state_.tool != Tool::kNone || click.twice;
    const auto point = picks ? frame_.pick_finely(click.x, click.y) : std::nullopt;
    if (state_.tool != Tool::kNone) {
        if (click.twice && state_.tool == Tool::kMeasure) {
            finish_measuring();
        } else if (point) {
            use_tool(*point);
        } else {
            say("there is no surface under the cursor");
        }
        return;
    }
    if (click.twice) {
        chosen_pivot_ = point ? std::optional(point->position) : std::nullopt;
        say(point ? "this point is orbited now" : "nothing there to orbit");
        return;
    }
    const int lamp = lamp_at(click.x, click.y);
    if (state_.show_lamps && lamp >= 0) state_.selected = lamp;
}

void Session::take(const WheelTurn& wheel) {
    if (panel_.wants_mouse()) return;
    const WindowExtent screen = window_.screen();
    const auto point = frame_.pick(wheel.x, wheel.y);
    const auto there = point ? std::optional(point->position) : std::nullopt;
    if (navigator_.wheel(wheel.notches, wheel.x, wheel.y, there,
                         view_of_size(screen.width, screen.height))) {
        moved();
    }
}

/// What the panel's sliders say by now.
void Session::take_panel_values() {
    if (state_.scheme != navigator_.scheme()) {
        navigator_.set_scheme(state_.scheme);
        moved();
    }
    if (state_.vfov_deg != static_cast<float>(navigator_.camera().vfov_deg())) {
        navigator_.camera().set_vfov_deg(state_.vfov_deg);
        moved();
    }
    const double section = state_.cut ? state_.section : SurveyView{}.section;
    if (section != navigator_.survey().section) {
        navigator_.survey().section = section;
        moved();
    }
}

void Session::use_tool(const SurfacePoint& point) {
    switch (state_.tool) {
        case Tool::kMeasure:
            state_.open.points.push_back(point.position);
            if (state_.open.kind == MeasureKind::kLeg && state_.open.points.size() == 2) {
                finish_measuring();
            }
            break;
        case Tool::kPlaceLamp:
            add_lamp(state_.preset, point.position + point.normal * kOffWall, point.normal);
            state_.tool = Tool::kNone;
            break;
        case Tool::kAimLamp:
            if (state_.selected >= 0) {
                Lamp& lamp = state_.lamps[static_cast<std::size_t>(state_.selected)];
                lamp.direction = normalized(point.position - lamp.position, lamp.direction);
            }
            state_.tool = Tool::kNone;
            break;
        case Tool::kNone:
        case Tool::kMeter:
            break;
    }
}

/// True depth under the cursor, and the light meter's reading.
void Session::look_under_cursor() {
    const Input& in = window_.input();
    const bool measures = state_.tool == Tool::kMeasure || state_.tool == Tool::kMeter;
    if (!measures) {
        state_.under_cursor.reset();
        state_.reading.reset();
        return;
    }
    if (panel_.wants_mouse() || now_seconds() - metered_at_ < kMeterSeconds) return;
    metered_at_ = now_seconds();
    state_.under_cursor.reset();
    state_.reading.reset();
    const auto point = frame_.pick(in.cursor_x(), in.cursor_y());
    if (!point) return;
    state_.under_cursor = point->position;
    state_.cursor_distance = frame_.distance_to(point->position);
    if (state_.tool != Tool::kMeter || !light_) return;
    const Probe probe{point->position, vec3_cast<float>(point->normal)};
    const ProbeResult light = measure_light(light_->field(), std::span(&probe, 1)).front();
    state_.reading = LightReading{point->position, {light.direct, light.indirect}};
}

void Session::play_path(double seconds) {
    if (!state_.playing || state_.path.keys.empty()) return;
    state_.play_time += seconds;
    const double end = state_.path.keys.back().time;
    state_.playing = state_.play_time < end;
    navigator_.go_to(camera_at_time(state_.path, std::min(state_.play_time, end), Camera{}));
    moved();
}

/// The lamp whose handle is there, the nearest one; -1 for none.
int Session::lamp_at(double x, double y) const {
    const WindowExtent screen = window_.screen();
    const View view = view_of_size(screen.width, screen.height);
    int found = -1;
    double nearest = kHandleReach * double{window_.units_scale()};
    for (std::size_t i = 0; i < state_.lamps.size(); ++i) {
        const PixelPoint at = project(view, state_.lamps[i].position);
        const double off = std::hypot(at.x - x, at.y - y);
        if (at.depth <= 0 || off > nearest) continue;
        found = static_cast<int>(i);
        nearest = off;
    }
    return found;
}

}  // namespace glowworm

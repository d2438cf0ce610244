// What the user does with mouse and keys.
#include <algorithm>
#include <cmath>

#include "viewer/app/session.h"

namespace glowworm {
namespace {

constexpr double kHandleReach = 10.0;  // screen units round a lamp's handle
constexpr int kPickReach = 3;          // frame pixels searched round a hole
constexpr int kFineTile = 9;           // pixels drawn anew round a click, odd
constexpr double kOffWall = 0.15;      // m: a lamp on a wall hangs so far before it
constexpr double kMeterSeconds = 0.2;  // between two readings of the light meter

}  // namespace

void Session::take_input(double seconds) {
    Input& in = window_.input();
    if (window_.screen().height > 0) navigator_.set_screen_height(window_.screen().height);
    for (const KeyPress& press : in.pressed) {
        if (panel_.wants_keyboard()) break;
        const auto request = request_of_key(press.key, press.modifiers, navigator_.mode());
        if (request) carry_out(*request);
    }
    const std::vector<Request> asked = std::exchange(state_.requests, {});
    for (const Request& request : asked)
        carry_out(request);
    for (const auto& path : in.dropped)
        take_drop(path);

    if (!panel_.wants_mouse()) {
        take_drag();
        for (const Click& click : in.clicks)
            take_click(click);
        if (in.wheel != 0.0) {
            const WindowExtent screen = window_.screen();
            const auto point = pick(in.cursor_x, in.cursor_y);
            const auto there = point ? std::optional(point->position) : std::nullopt;
            if (navigator_.wheel(in.wheel, in.cursor_x, in.cursor_y, there,
                                 view_of_size(screen.width, screen.height))) {
                moved();
            }
        }
    }
    if (!in.dragging) dragged_lamp_ = -1;

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
    const FlyInput held = panel_.wants_keyboard() ? FlyInput{} : window_.held_keys();
    if (held.ahead != 0 || held.aside != 0 || held.rise != 0) state_.playing = false;
    if (navigator_.step(held, seconds)) moved();
    play_path(seconds);
    look_under_cursor();
    stale_ = stale_ || in.damaged;
    window_.clear_input();
}

void Session::take_drag() {
    const Input& in = window_.input();
    const WindowExtent screen = window_.screen();
    if (in.drag_began) {
        const auto point = pick(in.drag_from_x, in.drag_from_y);
        pivot_ = point ? std::optional(point->position) : std::nullopt;
        const bool handles = in.drag_button == MouseButton::kLeft && !in.drag_shift &&
                             state_.show_lamps && state_.tool == Tool::kNone;
        dragged_lamp_ = handles ? lamp_at(in.drag_from_x, in.drag_from_y) : -1;
        if (dragged_lamp_ >= 0) state_.selected = dragged_lamp_;
    }
    if (in.drag_x == 0 && in.drag_y == 0) return;
    if (dragged_lamp_ >= 0 && dragged_lamp_ < static_cast<int>(state_.lamps.size())) {
        Lamp& lamp = state_.lamps[static_cast<std::size_t>(dragged_lamp_)];
        const auto wall = pick(in.cursor_x, in.cursor_y);
        if (wall && lamp.kind != LampKind::kArea) {
            lamp.position = wall->position + wall->normal * kOffWall;
        }
        return;
    }
    const DragAction action =
        drag_action(navigator_.scheme(), navigator_.mode(), in.drag_button, in.drag_shift);
    // Looking about takes no point; what was double-clicked is orbited until another is.
    const bool orbits = action == DragAction::kOrbit || action == DragAction::kTurnZoom;
    state_.playing = false;
    navigator_.drag(action, in.drag_x, in.drag_y, orbits && chosen_pivot_ ? chosen_pivot_ : pivot_,
                    view_of_size(screen.width, screen.height));
    moved();
}

void Session::take_click(const Click& click) {
    if (click.button != MouseButton::kLeft) return;
    const bool picks = state_.tool != Tool::kNone || click.twice;
    const auto point = picks ? pick_finely(click.x, click.y) : std::nullopt;
    if (state_.tool != Tool::kNone) {
        if (click.twice && state_.tool == Tool::kMeasure) {
            finish_measuring();
        } else if (point) {
            use_tool(*point);
        } else {
            state_.message = "there is no surface under the cursor";
        }
        return;
    }
    if (click.twice) {
        chosen_pivot_ = point ? std::optional(point->position) : std::nullopt;
        state_.message = point ? "this point is orbited now" : "nothing there to orbit";
        return;
    }
    const int lamp = lamp_at(click.x, click.y);
    if (state_.show_lamps && lamp >= 0) state_.selected = lamp;
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
    const auto point = pick(in.cursor_x, in.cursor_y);
    state_.under_cursor = point ? std::optional(point->position) : std::nullopt;
    if (!point) {
        state_.reading.reset();
        return;
    }
    state_.cursor_distance = length(point->position - drawn_.position);
    if (state_.tool != Tool::kMeter) return;
    const Probe probe{point->position, vec3_cast<float>(point->normal)};
    const ProbeResult light = light_->field().measure(std::span(&probe, 1)).front();
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

/// The surface under a place of the window, in screen units, as the last frame shows it.
std::optional<SurfacePoint> Session::pick(double x, double y) {
    const WindowExtent screen = window_.screen();
    if (drawn_.width == 0 || screen.width == 0 || screen.height == 0) return std::nullopt;
    if (sharpening_.active()) return pick_in_tile(x, y);  // which the frame's surfaces are of
    const double frame_x = x * drawn_.width / screen.width;
    const double frame_y = y * drawn_.height / screen.height;
    // The nearest pixel that has a surface: thin gaps between points do not swallow a click.
    for (int reach = 0; reach <= kPickReach; ++reach) {
        for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
                if (std::max(std::abs(dx), std::abs(dy)) != reach) continue;
                const double at_x = frame_x + dx, at_y = frame_y + dy;
                if (at_x < 0 || at_y < 0 || at_x >= drawn_.width || at_y >= drawn_.height) continue;
                const auto pixel =
                    static_cast<std::size_t>(at_y) * static_cast<std::size_t>(drawn_.width) +
                    static_cast<std::size_t>(at_x);
                const auto surface = frame_.gbuffer().surfaces().read<gpu::vec4>(1, pixel).front();
                if (const auto point = surface_point(drawn_, surface, at_x, at_y)) return point;
            }
        }
    }
    return std::nullopt;
}

/// The same as the whole cloud shows it at the window's own resolution, however coarse the frame
/// is.
std::optional<SurfacePoint> Session::pick_finely(double x, double y) {
    if (sharpening_.active()) return pick_in_tile(x, y);
    const auto coarse = pick(x, y);
    const auto fine = pick_in_tile(x, y);
    drawn_ = {};  // the frame's surfaces are gone
    stale_ = true;
    return fine ? fine : coarse;
}

/// From a few pixels drawn anew; the frame then holds them and nothing else.
std::optional<SurfacePoint> Session::pick_in_tile(double x, double y) {
    const WindowExtent screen = window_.screen();
    const int left = static_cast<int>(x) - kFineTile / 2, top = static_cast<int>(y) - kFineTile / 2;
    const View tile =
        tile_of(view_of_size(screen.width, screen.height), left, top, kFineTile, kFineTile);
    frame_.draw(tile, light_->field(), Frame::Missing::kWaitFor);
    constexpr std::size_t kMiddle = kFineTile / 2 * kFineTile + kFineTile / 2;
    const auto surface = frame_.gbuffer().surfaces().read<gpu::vec4>(1, kMiddle).front();
    return surface_point(tile, surface, x - left, y - top);
}

/// The lamp whose handle is there, the nearest one; -1 for none.
int Session::lamp_at(double x, double y) const {
    const WindowExtent screen = window_.screen();
    const View view = view_of_size(screen.width, screen.height);
    int found = -1;
    double nearest = kHandleReach;
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

// What lies over the picture: handles, measured lines, the path, the scale bar, messages.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "viewer/app/panel.h"
#include "viewer/app/photometry.h"
#include "viewer/app/survey_view.h"

namespace glowworm {
namespace {

constexpr ImU32 kWhite = IM_COL32(255, 255, 255, 255), kBlack = IM_COL32(0, 0, 0, 200);
constexpr ImU32 kGrey = IM_COL32(150, 150, 150, 255);
constexpr ImU32 kYellow = IM_COL32(255, 220, 60, 255), kCyan = IM_COL32(90, 220, 255, 255);
constexpr double kNearest = 0.05;    // m: what is nearer is not drawn over the picture
constexpr double kAxisLength = 0.5;  // m: how a spot's aim is shown

ImVec2 at(double x, double y) {
    return {static_cast<float>(x), static_cast<float>(y)};
}

/// Where a point is on the screen; nothing behind the eye.
std::optional<ImVec2> on_screen(const View& view, const Vec3d& point) {
    const PixelPoint p = project(view, point);
    if (p.depth < kNearest) return std::nullopt;
    return at(p.x, p.y);
}

/// A place so many pixels of an ordinary screen to the right and down.
ImVec2 beside(ImVec2 place, float right, float down) {
    return {place.x + scaled(right), place.y + scaled(down)};
}

void draw_line(ImDrawList& list, const View& view, const Vec3d& a, const Vec3d& b, ImU32 color) {
    const auto from = on_screen(view, a), to = on_screen(view, b);
    if (!from || !to) return;
    list.AddLine(*from, *to, kBlack, scaled(4.0f));
    list.AddLine(*from, *to, color, scaled(2.0f));
}

void draw_text(ImDrawList& list, ImVec2 place, const std::string& text, ImU32 color = kWhite) {
    list.AddText({place.x + 1, place.y + 1}, kBlack, text.c_str());
    list.AddText(place, color, text.c_str());
}

ImU32 color_of(const Vec3f& strength) {
    const float brightest = std::max({strength.x, strength.y, strength.z, 1e-9f});
    const auto channel = [&](float v) {
        return static_cast<int>(255.0f * std::sqrt(std::clamp(v / brightest, 0.0f, 1.0f)));
    };
    return IM_COL32(channel(strength.x), channel(strength.y), channel(strength.z), 255);
}

void draw_lamps(ImDrawList& list, const WindowState& state, const View& view) {
    for (std::size_t i = 0; i < state.lamps.size(); ++i) {
        const Lamp& lamp = state.lamps[i];
        const bool selected = state.selected == static_cast<int>(i);
        const auto place = on_screen(view, lamp.position);
        if (!place) continue;
        if (lamp.kind == LampKind::kSpot) {
            draw_line(list, view, lamp.position, lamp.position + lamp.direction * kAxisLength,
                      color_of(lamp.strength));
        }
        list.AddCircleFilled(*place, scaled(5.0f), lamp.on ? color_of(lamp.strength) : kBlack);
        list.AddCircle(*place, scaled(selected ? 9.0f : 6.0f), selected ? kYellow : kBlack, 0,
                       scaled(2.0f));
        if (selected) draw_text(list, beside(*place, 12.0f, -8.0f), lamp.name, kYellow);
    }
}

void draw_measurement(ImDrawList& list, const View& view, const Measurement& m, ImU32 color) {
    for (std::size_t i = 0; i < m.points.size(); ++i) {
        if (i > 0) draw_line(list, view, m.points[i - 1], m.points[i], color);
        if (const auto p = on_screen(view, m.points[i]))
            list.AddCircleFilled(*p, scaled(4.0f), color);
    }
    if (m.kind == MeasureKind::kPolygon && m.points.size() > 2) {
        draw_line(list, view, m.points.back(), m.points.front(), color);
    }
    if (m.points.size() < 2) return;
    const auto label = on_screen(view, (m.points[0] + m.points[1]) / 2.0);
    if (!label) return;
    const std::string text = measurement_text(m);
    draw_text(list, beside(*label, 8.0f, 0.0f), text.substr(0, text.find(',')), color);
}

void draw_path(ImDrawList& list, const WindowState& state, const View& view) {
    const CameraPath& path = state.path;
    if (path.keys.empty()) return;
    constexpr int kPieces = 100;
    const double begin = path.keys.front().time, end = path.keys.back().time;
    Vec3d before = path.keys.front().position;
    for (int i = 1; i <= kPieces && path.keys.size() > 1; ++i) {
        const double time = begin + (end - begin) * i / kPieces;
        const Vec3d now = camera_at_time(path, time, Camera{}).position;
        draw_line(list, view, before, now, kCyan);
        before = now;
    }
    for (std::size_t i = 0; i < path.keys.size(); ++i) {
        const auto place = on_screen(view, path.keys[i].position);
        if (!place) continue;
        list.AddRectFilled(beside(*place, -4.0f, -4.0f), beside(*place, 4.0f, 4.0f), kCyan);
        draw_text(list, beside(*place, 7.0f, -7.0f), fmt::format("{}", i + 1), kCyan);
    }
}

/// A survey's scale bar and north arrow, at the lower right.
void draw_scale(ImDrawList& list, const View& view) {
    const double metres = scale_bar_length(1.0 / view.focal, view.width / 4.0);
    const ImVec2 corner = at(view.width, view.height), right = beside(corner, -30.0f, -30.0f);
    const auto bar = static_cast<float>(metres * view.focal);
    const ImVec2 left{right.x - bar, right.y}, middle{right.x - bar / 2, right.y};
    list.AddRectFilled(beside(left, -1.0f, -3.0f), beside(right, 1.0f, 4.0f), kBlack);
    list.AddRectFilled(beside(left, 0.0f, -2.0f), beside(right, 0.0f, 3.0f), kWhite);
    list.AddRectFilled(beside(middle, 0.0f, -2.0f), beside(right, 0.0f, 3.0f), kGrey);
    draw_text(list, beside(left, 0.0f, -20.0f), fmt::format("{:g} m", metres));

    const ScreenDirection north = north_on_screen(view);
    const auto reach = static_cast<float>(std::hypot(north.right, north.down));
    if (reach < 0.05f) return;  // along the line of sight
    const auto nx = static_cast<float>(north.right), ny = static_cast<float>(north.down);
    constexpr float kArrow = 30.0f;
    const ImVec2 centre = beside(corner, -50.0f, -95.0f);
    const ImVec2 tip = beside(centre, nx * kArrow, ny * kArrow);
    const ImVec2 foot = beside(centre, -nx * kArrow, -ny * kArrow);
    list.AddLine(foot, tip, kBlack, scaled(5.0f));
    list.AddLine(foot, tip, kWhite, scaled(2.0f));
    const float ux = nx / reach, uy = ny / reach;  // the head keeps its size
    list.AddTriangleFilled(tip, beside(tip, -ux * 10 - uy * 5, -uy * 10 + ux * 5),
                           beside(tip, -ux * 10 + uy * 5, -uy * 10 - ux * 5), kWhite);
    draw_text(list, beside(tip, ux * 12 - 4, uy * 12 - 7), "N");
}

const char* hint_for(const WindowState& state) {
    switch (state.tool) {
        case Tool::kNone:
            return nullptr;
        case Tool::kMeasure:
            return state.open.kind == MeasureKind::kLeg
                       ? "click two points; Esc ends"
                       : "click points; Enter ends the line, Esc ends measuring";
        case Tool::kMeter:
            return "light under the cursor; Esc ends";
        case Tool::kPlaceLamp:
            return "click the wall where the lamp is to hang";
        case Tool::kAimLamp:
            return "click what the lamp is to aim at";
    }
    return nullptr;
}

void draw_boxed(ImDrawList& list, ImVec2 place, const std::string& text, float wrap) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
    const ImVec2 end{place.x + size.x, place.y + size.y};
    list.AddRectFilled(beside(place, -4.0f, -3.0f), beside(end, 4.0f, 3.0f), kBlack, scaled(3.0f));
    list.AddText(ImGui::GetFont(), ImGui::GetFontSize(), place, kWhite, text.c_str(), nullptr,
                 wrap);
}

/// How far what is under the cursor is, and what light falls on it.
void draw_at_cursor(ImDrawList& list, const WindowState& state) {
    if (!state.under_cursor || ImGui::GetIO().WantCaptureMouse) return;
    std::string text = fmt::format("{:.3f} m away", state.cursor_distance);
    if (state.reading) {
        const Irradiance& e = state.reading->irradiance;
        const double direct = luminance_of(e.direct), reflected = luminance_of(e.indirect);
        const double lux = (direct + reflected) * kLuminousEfficacy;
        text = fmt::format("{:.4g} W/m2, {:.4g} lx\n{:.0f} % reflected\n{}", direct + reflected,
                           lux, 100.0 * reflected / std::max(direct + reflected, 1e-30), text);
    }
    draw_boxed(list, beside(ImGui::GetMousePos(), 18.0f, 14.0f), text, 0.0f);
}

/// The last thing that happened, at the lower edge beside the panel.
void draw_message(ImDrawList& list, const WindowState& state, const View& view) {
    const auto width = static_cast<float>(view.width), height = static_cast<float>(view.height);
    const float margin = scaled(12.0f);
    const float left = state.visible && width > scaled(500.0f) ? scaled(345.0f) : margin;
    const float wrap = std::max(width - left - margin, scaled(100.0f));
    const char* text = state.message.c_str();
    const ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, wrap);
    const ImVec2 place{left, height - margin - size.y};
    draw_boxed(list, place, text, wrap);
}

}  // namespace

void draw_overlay(const WindowState& state, const View& view) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    if (state.visible) {
        if (state.show_path && !state.playing) draw_path(list, state, view);
        if (state.show_lamps) draw_lamps(list, state, view);
        if (state.show_stations) {
            for (const Mark& station : state.stations) {
                const auto place = on_screen(view, station.position);
                if (!place) continue;
                list.AddTriangleFilled(beside(*place, 0.0f, -6.0f), beside(*place, -5.0f, 4.0f),
                                       beside(*place, 5.0f, 4.0f), kYellow);
                draw_text(list, beside(*place, 8.0f, -7.0f), station.name, kYellow);
            }
        }
        for (const Measurement& m : state.measurements)
            draw_measurement(list, view, m, kWhite);
        draw_measurement(list, view, state.open, kYellow);
    }
    if (view.orthographic) draw_scale(list, view);
    const char* hint = hint_for(state);
    if (hint != nullptr) {
        draw_text(list, beside(at(view.width / 2.0, 0.0), -100.0f, 12.0f), hint, kYellow);
    }
    draw_at_cursor(list, state);
    if (!state.message.empty()) draw_message(list, state, view);
}

}  // namespace glowworm

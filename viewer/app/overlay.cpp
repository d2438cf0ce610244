// What lies over the picture: handles, measured lines, the path, the scale bar, messages.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "viewer/app/panel.h"
#include "viewer/app/survey_view.h"

namespace glowworm {
namespace {

constexpr ImU32 kWhite = IM_COL32(255, 255, 255, 255), kBlack = IM_COL32(0, 0, 0, 200);
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

void draw_line(ImDrawList& list, const View& view, const Vec3d& a, const Vec3d& b, ImU32 color) {
    const auto from = on_screen(view, a), to = on_screen(view, b);
    if (!from || !to) return;
    list.AddLine(*from, *to, kBlack, 4.0f);
    list.AddLine(*from, *to, color, 2.0f);
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
        list.AddCircleFilled(*place, 5.0f, lamp.on ? color_of(lamp.strength) : kBlack);
        list.AddCircle(*place, selected ? 9.0f : 6.0f, selected ? kYellow : kBlack, 0, 2.0f);
        if (selected) draw_text(list, {place->x + 12, place->y - 8}, lamp.name, kYellow);
    }
}

void draw_measurement(ImDrawList& list, const View& view, const Measurement& m, ImU32 color) {
    for (std::size_t i = 0; i < m.points.size(); ++i) {
        if (i > 0) draw_line(list, view, m.points[i - 1], m.points[i], color);
        if (const auto p = on_screen(view, m.points[i])) list.AddCircleFilled(*p, 4.0f, color);
    }
    if (m.kind == MeasureKind::kPolygon && m.points.size() > 2) {
        draw_line(list, view, m.points.back(), m.points.front(), color);
    }
    if (m.points.size() < 2) return;
    const auto label = on_screen(view, (m.points[0] + m.points[1]) / 2.0);
    if (!label) return;
    const std::string text = measurement_text(m);
    draw_text(list, {label->x + 8, label->y}, text.substr(0, text.find(',')), color);
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
        list.AddRectFilled({place->x - 4, place->y - 4}, {place->x + 4, place->y + 4}, kCyan);
        draw_text(list, {place->x + 7, place->y - 7}, fmt::format("{}", i + 1), kCyan);
    }
}

/// A survey's scale bar and north arrow, at the lower right.
void draw_scale(ImDrawList& list, const View& view) {
    const double metres = scale_bar_length(1.0 / view.focal, view.width / 4.0);
    const double pixels = metres * view.focal, x = view.width - 30.0, y = view.height - 30.0;
    list.AddRectFilled(at(x - pixels - 1, y - 3), at(x + 1, y + 4), kBlack);
    list.AddRectFilled(at(x - pixels, y - 2), at(x, y + 3), kWhite);
    list.AddRectFilled(at(x - pixels / 2, y - 2), at(x, y + 3), IM_COL32(150, 150, 150, 255));
    draw_text(list, at(x - pixels, y - 20), fmt::format("{:g} m", metres));

    const ScreenDirection north = north_on_screen(view);
    const double reach = std::hypot(north.right, north.down);
    if (reach < 0.05) return;  // along the line of sight
    const double nx = north.right, ny = north.down, cx = view.width - 50.0, cy = view.height - 95.0;
    constexpr double kArrow = 30.0;
    const ImVec2 tip = at(cx + nx * kArrow, cy + ny * kArrow);
    const ImVec2 foot = at(cx - nx * kArrow, cy - ny * kArrow);
    list.AddLine(foot, tip, kBlack, 5.0f);
    list.AddLine(foot, tip, kWhite, 2.0f);
    const double ux = nx / reach, uy = ny / reach;  // the head keeps its size
    list.AddTriangleFilled(tip, at(tip.x - ux * 10 - uy * 5, tip.y - uy * 10 + ux * 5),
                           at(tip.x - ux * 10 + uy * 5, tip.y - uy * 10 - ux * 5), kWhite);
    draw_text(list, at(tip.x + ux * 12 - 4, tip.y + uy * 12 - 7), "N");
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

/// The last thing that happened, at the lower edge beside the panel.
void draw_message(ImDrawList& list, const WindowState& state, const View& view) {
    const float left = state.visible && view.width > 500 ? 345.0f : 12.0f;
    const float wrap = std::max(static_cast<float>(view.width) - left - 12.0f, 100.0f);
    const char* text = state.message.c_str();
    const ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, wrap);
    const ImVec2 place{left, static_cast<float>(view.height) - 12.0f - size.y};
    list.AddRectFilled({place.x - 4, place.y - 3}, {place.x + size.x + 4, place.y + size.y + 3},
                       kBlack, 3.0f);
    list.AddText(ImGui::GetFont(), ImGui::GetFontSize(), place, kWhite, text, nullptr, wrap);
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
                list.AddTriangleFilled({place->x, place->y - 6}, {place->x - 5, place->y + 4},
                                       {place->x + 5, place->y + 4}, kYellow);
                draw_text(list, {place->x + 8, place->y - 7}, station.name, kYellow);
            }
        }
        for (const Measurement& m : state.measurements)
            draw_measurement(list, view, m, kWhite);
        draw_measurement(list, view, state.open, kYellow);
    }
    if (view.orthographic) draw_scale(list, view);
    const char* hint = hint_for(state);
    if (hint != nullptr) draw_text(list, at(view.width / 2.0 - 100, 12), hint, kYellow);
    if (!state.message.empty()) draw_message(list, state, view);
}

}  // namespace glowworm

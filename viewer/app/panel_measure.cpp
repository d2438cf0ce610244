// Panel sections: measuring, the camera path, statistics.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "octree/resident_memory.h"
#include "viewer/app/panel.h"
#include "viewer/app/photometry.h"

namespace glowworm {
namespace {

void tool_button(WindowState& state, const char* label, Command command) {
    if (ImGui::Button(label)) state.requests.push_back({command});
}

void draw_reading(const LightReading& reading) {
    const Irradiance& e = reading.irradiance;
    const auto line = [](const char* name, const Vec3f& value) {
        const double watts = luminance_of(value);
        ImGui::Text("%-9s %.4g W/m2, %.4g lx", name, watts, watts * kLuminousEfficacy);
    };
    line("direct", e.direct);
    line("reflected", e.indirect);
    line("together", e.direct + e.indirect);
    ImGui::TextDisabled("weighted by luminance; 179 lm/W");
}

}  // namespace

void draw_measure_section(WindowState& state) {
    tool_button(state, "distance (M)", Command::kMeasureLeg);
    ImGui::SameLine();
    tool_button(state, "line", Command::kMeasurePolyline);
    ImGui::SameLine();
    tool_button(state, "area (G)", Command::kMeasurePolygon);
    ImGui::SameLine();
    tool_button(state, "light (I)", Command::kMeterLight);
    if (state.under_cursor) {
        const Vec3d& p = *state.under_cursor;
        ImGui::Text("%.3f %.3f %.3f, %.3f m away", p.x, p.y, p.z, state.cursor_distance);
    }
    if (state.reading) draw_reading(*state.reading);
    int removed = -1;
    std::string all;
    for (std::size_t i = 0; i < state.measurements.size(); ++i) {
        const std::string text = measurement_text(state.measurements[i]);
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::SmallButton("x")) removed = static_cast<int>(i);
        ImGui::SameLine();
        ImGui::TextWrapped("%s", text.c_str());
        ImGui::PopID();
        all += text + '\n';
    }
    if (removed >= 0) state.measurements.erase(state.measurements.begin() + removed);
    if (state.measurements.empty()) return;
    if (ImGui::Button("copy")) ImGui::SetClipboardText(all.c_str());
    ImGui::SameLine();
    tool_button(state, "save as JSON (Ctrl+M)", Command::kSaveMeasurements);
}

void draw_path_section(WindowState& state) {
    std::vector<PathKey>& keys = state.path.keys;
    int removed = -1;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::SmallButton("x")) removed = static_cast<int>(i);
        ImGui::SameLine();
        if (ImGui::SmallButton("go")) {
            state.requests.push_back({Command::kGoToKeyframe, static_cast<int>(i)});
        }
        ImGui::SameLine();
        auto seconds = static_cast<float>(keys[i].time);
        if (ImGui::DragFloat("s", &seconds, 0.02f, 0.0f, 1e5f, "%.2f")) {
            // Between its neighbours: the order of keys is the order of times.
            const double least = i > 0 ? keys[i - 1].time + 0.01 : 0.0;
            const double most = i + 1 < keys.size() ? keys[i + 1].time - 0.01 : 1e5;
            keys[i].time = std::clamp<double>(seconds, least, std::max(least, most));
        }
        ImGui::PopID();
    }
    if (removed >= 0) keys.erase(keys.begin() + removed);
    if (keys.empty()) state.playing = false;
    tool_button(state, "add keyframe (K)", Command::kAddKeyframe);
    ImGui::SameLine();
    tool_button(state, state.playing ? "stop" : "play", Command::kPlayPath);
    ImGui::SameLine();
    tool_button(state, "save (Ctrl+K)", Command::kSavePath);
    ImGui::PushTextWrapPos();
    ImGui::TextDisabled("glowworm-view --headless --path makes a video");
    ImGui::PopTextWrapPos();
}

void draw_statistics_section(WindowState& state) {
    if (!state.frame_history.empty()) {
        ImGui::PlotLines("ms a frame", state.frame_history.data(),
                         static_cast<int>(state.frame_history.size()), 0, nullptr, 0.0f,
                         *std::max_element(state.frame_history.begin(), state.frame_history.end()),
                         {0, scaled(50.0f)});
    }
    ImGui::Checkbox("milliseconds of each pass", &state.measure_passes);
    if (state.measure_passes) {
        for (const auto& [name, ms] : state.passes)
            ImGui::Text("%-14s %8.2f ms", name.c_str(), ms);
    }
    ImGui::Text("%llu points drawn", static_cast<unsigned long long>(state.points_drawn));
    if (state.points_without_room > 0) {
        ImGui::TextWrapped("coarser than it is: --gpu-memory has no room for %llu more",
                           static_cast<unsigned long long>(state.points_without_room));
    }
    ImGui::Text("%.0f MB of memory", static_cast<double>(resident_bytes()) / 1e6);
    ImGui::TextWrapped("%s", state.file_facts.c_str());
}

}  // namespace glowworm

// Panel sections: lamps, and how their light is computed.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "viewer/app/panel.h"
#include "viewer/app/photometry.h"

namespace glowworm {
namespace {

/// Colour and power of a lamp; each stays when the other changes.
void edit_strength(Lamp& lamp) {
    const float brightest = std::max({lamp.strength.x, lamp.strength.y, lamp.strength.z, 1e-9f});
    Vec3f shown = lamp.strength / brightest;
    if (ImGui::ColorEdit3("colour", &shown.x, ImGuiColorEditFlags_Float)) set_color(lamp, shown);
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    float kelvin = 4000.0f;
    if (ImGui::SliderFloat("as temperature", &kelvin, 1700.0f, 12000.0f, "slide to set, K")) {
        set_color(lamp, color_of_temperature(kelvin));
    }
    auto watts = static_cast<float>(power_of(lamp));
    float lumens = watts * static_cast<float>(kLuminousEfficacy);
    if (ImGui::DragFloat("W", &watts, 0.01f * std::max(watts, 0.1f), 0.0f, 1e5f, "%.3f")) {
        lamp.strength = strength_for(lamp, std::max(watts, 0.0f));
    }
    if (ImGui::DragFloat("lm (179 lm/W)", &lumens, 0.01f * std::max(lumens, 10.0f), 0.0f, 1e7f,
                         "%.0f")) {
        lamp.strength = strength_for(lamp, std::max(lumens, 0.0f) / kLuminousEfficacy);
    }
    ImGui::TextDisabled(
        lamp.kind == LampKind::kArea ? "%.3f %.3f %.3f W/sr/m2" : "%.3f %.3f %.3f W/sr",
        static_cast<double>(lamp.strength.x), static_cast<double>(lamp.strength.y),
        static_cast<double>(lamp.strength.z));
}

void edit_spot(WindowState& state, Lamp& lamp) {
    auto cone = static_cast<float>(lamp.cone_deg), blend = static_cast<float>(lamp.blend);
    if (ImGui::SliderFloat("cone", &cone, 1.0f, 180.0f, "%.0f deg")) lamp.cone_deg = cone;
    if (ImGui::SliderFloat("blend", &blend, 0.0f, 1.0f, "%.2f")) lamp.blend = blend;
    if (ImGui::Button("aim at a click")) state.requests.push_back({Command::kAimLamp});
}

void edit_selected(WindowState& state) {
    Lamp& lamp = state.lamps[static_cast<std::size_t>(state.selected)];
    ImGui::Separator();
    ImGui::TextUnformatted(lamp.name.c_str());
    edit_strength(lamp);
    if (lamp.kind == LampKind::kSpot) edit_spot(state, lamp);
    if (lamp.kind == LampKind::kArea) return;
    ImGui::DragScalarN("position", ImGuiDataType_Double, &lamp.position.x, 3, 0.01f, nullptr,
                       nullptr, "%.2f");
    if (ImGui::Button("remove (X)")) state.requests.push_back({Command::kRemoveLamp});
}

void add_lamps(WindowState& state) {
    const auto presets = lamp_presets();
    const auto& preset = presets[static_cast<std::size_t>(state.preset)];
    if (ImGui::BeginCombo("new lamp", preset.name)) {
        for (std::size_t i = 0; i < presets.size(); ++i) {
            if (ImGui::Selectable(presets[i].name)) state.preset = static_cast<int>(i);
        }
        ImGui::EndCombo();
    }
    ImGui::TextDisabled("%.0f lm, %.0f K", preset.lumens, preset.kelvin);
    if (ImGui::Button("add here (B)")) {
        state.requests.push_back({Command::kAddLamp, state.preset});
    }
    ImGui::SameLine();
    if (ImGui::Button("add at a click")) {
        state.requests.push_back({Command::kPlaceLamp, state.preset});
    }
}

void button(WindowState& state, const char* label, Command command, bool enabled) {
    if (!enabled) ImGui::BeginDisabled();
    if (ImGui::Button(label)) state.requests.push_back({command});
    if (!enabled) ImGui::EndDisabled();
}

}  // namespace

void draw_lamp_section(WindowState& state) {
    ImGui::Checkbox("headlamp (H)", &state.headlamp_on);
    ImGui::SliderFloat("W/sr", &state.headlamp_intensity, 0.01f, 100.0f, "%.2f",
                       ImGuiSliderFlags_Logarithmic);
    for (std::size_t i = 0; i < state.lamps.size(); ++i) {
        Lamp& lamp = state.lamps[i];
        ImGui::PushID(static_cast<int>(i));
        ImGui::Checkbox("##on", &lamp.on);
        ImGui::SameLine();
        if (ImGui::Selectable(lamp.name.c_str(), state.selected == static_cast<int>(i))) {
            state.selected = static_cast<int>(i);
        }
        ImGui::PopID();
    }
    if (state.selected >= 0 && state.selected < static_cast<int>(state.lamps.size())) {
        edit_selected(state);
    }
    ImGui::Separator();
    add_lamps(state);
    button(state, "undo", Command::kUndo, state.can_undo);
    ImGui::SameLine();
    button(state, "redo", Command::kRedo, state.can_redo);
    ImGui::InputText("scene file", &state.scene_file);
    button(state, "save (Ctrl+S)", Command::kSaveScene, true);
    ImGui::SameLine();
    button(state, "load (Ctrl+O)", Command::kLoadScene, true);
}

void draw_light_section(WindowState& state) {
    bool changed = ImGui::Checkbox("limit bounces", &state.limit_bounces);
    if (state.limit_bounces) {
        changed |= ImGui::SliderInt("bounces", &state.bounces, 0, 50);
    }
    int gather = static_cast<int>(state.light.gather);
    constexpr const char* kGathers[] = {"links", "cones"};
    if (ImGui::Combo("gather by", &gather, kGathers, 2)) {
        state.light.gather = static_cast<Gather>(gather);
        changed = true;
    }
    if (state.light.gather == Gather::kCones) {
        constexpr int kCones[] = {4, 5, 6, 9, 10, 16};
        for (const int cones : kCones) {
            ImGui::PushID(cones);
            if (cones != kCones[0]) ImGui::SameLine();
            char label[4] = {};
            std::snprintf(label, sizeof label, "%d", cones);
            changed |= ImGui::RadioButton(label, &state.light.cones, cones);
            ImGui::PopID();
        }
    }
    if (changed) state.requests.push_back({Command::kRebuildLight});
    if (state.residuals.size() > 1) {
        std::vector<float> digits;
        for (const float residual : state.residuals)
            digits.push_back(std::log10(std::max(residual, 1e-7f)));
        ImGui::PlotLines("log10 of change", digits.data(), static_cast<int>(digits.size()), 0,
                         nullptr, -5.0f, 0.5f, {0, scaled(60.0f)});
    }
}

}  // namespace glowworm

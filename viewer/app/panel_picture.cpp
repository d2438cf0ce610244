// Panel sections: the picture, and moving.
#include <imgui.h>

#include "viewer/app/panel.h"

namespace glowworm {
namespace {

bool combo(const char* label, int* which, const char* const* names, std::size_t count) {
    return ImGui::Combo(label, which, names, static_cast<int>(count));
}

void ask(WindowState& state, const char* label, Command command) {
    if (ImGui::Button(label)) state.requests.push_back({command});
}

void draw_survey_controls(WindowState& state) {
    ask(state, "N", Command::kFaceNorth);
    ImGui::SameLine();
    ask(state, "E", Command::kFaceEast);
    ImGui::SameLine();
    ask(state, "S", Command::kFaceSouth);
    ImGui::SameLine();
    ask(state, "W", Command::kFaceWest);
    ImGui::SameLine();
    ask(state, "rotate", Command::kRotate);
    ImGui::Checkbox("section plane", &state.cut);
    if (state.cut) ImGui::SliderFloat("m off middle", &state.section, -50.0f, 50.0f, "%.2f");
}

void draw_clip_box(WindowState& state) {
    ImGui::Checkbox("clip box", &state.clip);
    ImGui::SameLine();
    ask(state, "4 m round here", Command::kClipHere);
    if (!state.clip) return;
    constexpr float kMetresPerPixel = 0.02f;
    ImGui::DragScalarN("from, m", ImGuiDataType_Double, &state.clip_box.low.x, 3, kMetresPerPixel,
                       nullptr, nullptr, "%.2f");
    ImGui::DragScalarN("to, m", ImGuiDataType_Double, &state.clip_box.high.x, 3, kMetresPerPixel,
                       nullptr, nullptr, "%.2f");
}

}  // namespace

void draw_picture_section(WindowState& state) {
    ImGui::Checkbox("automatic exposure", &state.automatic_exposure);
    if (state.automatic_exposure) ImGui::BeginDisabled();
    ImGui::SliderFloat("exposure", &state.exposure, -12.0f, 12.0f, "%.2f EV");
    if (state.automatic_exposure) ImGui::EndDisabled();
    int curve = static_cast<int>(state.curve), layer = static_cast<int>(state.layer);
    combo("tone curve", &curve, kToneCurveNames, std::size(kToneCurveNames));
    combo("show", &layer, kLayerNames, std::size(kLayerNames));
    if (of_octree(static_cast<Layer>(layer))) {
        ImGui::SliderInt("level", &state.level, 0, state.levels - 1);
    }
    state.curve = static_cast<ToneCurve>(curve);
    state.layer = static_cast<Layer>(layer);
    ImGui::SliderFloat("point budget", &state.pixels_between_points, 0.3f, 4.0f,
                       "a point each %.1f px");
    ImGui::SliderFloat("wetness", &state.wetness, 0.0f, 1.0f, "%.2f");
    draw_clip_box(state);
    ImGui::Checkbox("lamps", &state.show_lamps);
    ImGui::SameLine();
    ImGui::Checkbox("stations", &state.show_stations);
    ImGui::SameLine();
    ImGui::Checkbox("path", &state.show_path);
    ask(state, "save picture (F12)", Command::kSavePicture);
}

void draw_move_section(WindowState& state) {
    ask(state, "fly", Command::kFly);
    ImGui::SameLine();
    ask(state, "orbit", Command::kOrbit);
    ImGui::SameLine();
    ask(state, "walk", Command::kWalk);
    ImGui::SameLine();
    ask(state, "plan", Command::kPlan);
    ImGui::SameLine();
    ask(state, "elevation", Command::kElevation);
    if (state.mode == MoveMode::kSurvey) draw_survey_controls(state);
    int scheme = static_cast<int>(state.scheme);
    combo("controls", &scheme, kControlNames, std::size(kControlNames));
    state.scheme = static_cast<ControlScheme>(scheme);
    ImGui::SliderFloat("field of view", &state.vfov_deg, 10.0f, 120.0f, "%.0f deg");
    if (!state.stations.empty() && ImGui::TreeNode("go to a station")) {
        for (std::size_t i = 0; i < state.stations.size(); ++i) {
            ImGui::PushID(static_cast<int>(i));
            if (ImGui::Selectable(state.stations[i].name.c_str())) {
                state.requests.push_back({Command::kGoToStation, static_cast<int>(i)});
            }
            ImGui::PopID();
        }
        ImGui::TreePop();
    }
}

}  // namespace glowworm

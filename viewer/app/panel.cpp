#include "viewer/app/panel.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

namespace glowworm {
namespace {

constexpr const char* kKeys =
    "W A S D      fly ahead, left, back, right\n"
    "R F          up, down\n"
    "drag         look around\n"
    "wheel        speed; it stays\n"
    "H            headlamp on, off\n"
    "F12          save the picture (PNG and EXR)\n"
    "Tab          hide the panels\n"
    "F1           these keys\n"
    "Esc          close";

void draw_display(PanelState& state) {
    ImGui::Checkbox("automatic exposure", &state.automatic_exposure);
    if (state.automatic_exposure) ImGui::BeginDisabled();
    ImGui::SliderFloat("exposure", &state.exposure, -12.0f, 12.0f, "%.2f EV");
    if (state.automatic_exposure) ImGui::EndDisabled();
    int curve = static_cast<int>(state.curve);
    ImGui::Combo("tone curve", &curve, kToneCurveNames, 4);
    state.curve = static_cast<ToneCurve>(curve);
}

bool draw_lamps(PanelState& state) {
    bool changed = ImGui::Checkbox("headlamp", &state.headlamp_on);
    changed |= ImGui::SliderFloat("W/sr", &state.headlamp_intensity, 0.0f, 50.0f, "%.2f",
                                  ImGuiSliderFlags_Logarithmic);
    for (std::size_t i = 0; i < state.lamps.size(); ++i) {
        LampControl& lamp = state.lamps[i];
        ImGui::PushID(static_cast<int>(i));
        changed |= ImGui::Checkbox("##on", &lamp.on);
        ImGui::SameLine();
        changed |= ImGui::ColorEdit3("##tint", lamp.tint, ImGuiColorEditFlags_NoInputs);
        ImGui::SameLine();
        ImGui::SetNextItemWidth(90.0f);
        changed |= ImGui::SliderFloat(lamp.name.c_str(), &lamp.brightness, 0.0f, 10.0f, "x %.2f",
                                      ImGuiSliderFlags_Logarithmic);
        ImGui::PopID();
    }
    return changed;
}

}  // namespace

Panel::Panel(GLFWwindow* window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // nothing is left behind in the user's folder
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 450");
}

Panel::~Panel() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

bool Panel::draw(PanelState& state) {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    bool changed = false;
    if (state.visible) {
        ImGui::SetNextWindowPos({10, 10}, ImGuiCond_FirstUseEver);
        ImGui::SetNextWindowSize({310, 420}, ImGuiCond_FirstUseEver);
        ImGui::Begin("Glowworm");
        ImGui::Text("%.0f ms a frame at 1/%d, %.2f m/s", state.frame_ms, state.divisor,
                    static_cast<double>(state.speed));
        ImGui::TextWrapped("light: %s", state.light_status.c_str());
        if (!state.message.empty()) ImGui::TextWrapped("%s", state.message.c_str());
        ImGui::Separator();
        draw_display(state);
        ImGui::Separator();
        changed = draw_lamps(state);
        ImGui::Separator();
        ImGui::TextDisabled("F1 shows the keys");
        ImGui::End();
    }
    if (state.show_keys) {
        ImGui::Begin("Keys", &state.show_keys, ImGuiWindowFlags_AlwaysAutoResize);
        ImGui::TextUnformatted(kKeys);
        ImGui::End();
    }
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    return changed;
}

bool Panel::wants_mouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}

bool Panel::wants_keyboard() const {
    return ImGui::GetIO().WantTextInput;
}

}  // namespace glowworm

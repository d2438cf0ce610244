#include "viewer/app/panel.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <GLFW/glfw3.h>

namespace glowworm {
namespace {

void draw_keys(WindowState& state) {
    ImGui::SetNextWindowPos({340, 10}, ImGuiCond_FirstUseEver);
    ImGui::Begin("Keys", &state.show_keys, ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::TextUnformatted(mouse_help(state.scheme, state.mode).c_str());
    ImGui::TextUnformatted(key_help(state.mode).c_str());
    ImGui::End();
}

void draw_sections(WindowState& state) {
    const struct {
        const char* name;
        void (*draw)(WindowState&);
        bool open;
    } sections[] = {{"Picture", draw_picture_section, true},
                    {"Moving", draw_move_section, false},
                    {"Lamps", draw_lamp_section, true},
                    {"Light", draw_light_section, false},
                    {"Measuring", draw_measure_section, false},
                    {"Camera path", draw_path_section, false},
                    {"Statistics", draw_statistics_section, false}};
    for (const auto& section : sections) {
        const ImGuiTreeNodeFlags flags = section.open ? ImGuiTreeNodeFlags_DefaultOpen : 0;
        if (!ImGui::CollapsingHeader(section.name, flags)) continue;
        ImGui::PushID(section.name);
        section.draw(state);
        ImGui::PopID();
    }
}

}  // namespace

Panel::Panel(GLFWwindow* window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // nothing is left behind in the user's folder
    float scale = 1.0f, ignored = 1.0f;
    glfwGetWindowContentScale(window, &scale, &ignored);
    if (scale > 1.0f) {
        ImGui::GetIO().FontGlobalScale = scale;
        ImGui::GetStyle().ScaleAllSizes(scale);
    }
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 450");
}

Panel::~Panel() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Panel::draw(WindowState& state, const View& view) {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    draw_overlay(state, view);
    if (state.visible) {
        // Where people put it, until the window gets another size: it might lie outside then.
        const ImGuiCond when = view.height == height_ ? ImGuiCond_Once : ImGuiCond_Always;
        height_ = view.height;
        ImGui::SetNextWindowPos({10, 10}, when);
        ImGui::SetNextWindowSize({320, static_cast<float>(view.height) - 20}, when);
        ImGui::Begin("Glowworm");
        ImGui::PushItemWidth(-110.0f);
        ImGui::Text("%.0f ms a frame at 1/%d, %.0f %% sharp", state.frame_ms, state.divisor,
                    (state.divisor == 1 ? 1.0 : state.sharpened) * 100.0);
        ImGui::Text("flies at %.2f m/s", static_cast<double>(state.speed));
        ImGui::TextWrapped("light: %s", state.light_status.c_str());
        ImGui::TextDisabled("F1 shows the keys, Tab hides the panels");
        draw_sections(state);
        ImGui::PopItemWidth();
        ImGui::End();
    }
    if (state.show_keys) draw_keys(state);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool Panel::wants_mouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}

bool Panel::wants_keyboard() const {
    return ImGui::GetIO().WantTextInput;
}

bool Panel::is_editing() const {
    return ImGui::IsAnyItemActive();
}

}  // namespace glowworm

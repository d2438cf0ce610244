#include "viewer/app/panel.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <cmath>

namespace glowworm {
namespace {

constexpr float kFontPixels = 13.0f;  // what the default font is made for

void draw_keys(WindowState& state) {
    ImGui::SetNextWindowPos({scaled(340.0f), scaled(10.0f)}, ImGuiCond_FirstUseEver);
    ImGui::Begin("Keys", &state.show_keys, ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::TextUnformatted(mouse_help(state.scheme, state.mode).c_str());
    ImGui::TextUnformatted(key_help(state.mode).c_str());
    ImGui::End();
}

/// Always two lines: what is below stays where a hand is reaching for it.
void draw_light_status(const std::string& status) {
    const float top = ImGui::GetCursorPosY();
    ImGui::TextWrapped("light: %s", status.c_str());
    ImGui::SetCursorPosY(top + 2.0f * ImGui::GetTextLineHeightWithSpacing());
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

float scaled(float pixels) {
    return pixels * ImGui::GetFontSize() / kFontPixels;
}

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

/// Letters are drawn anew for each size: stretched ones would be blurred.
void Panel::set_scale(float scale) {
    if (scale == scale_) return;
    scale_ = scale;
    ImGui::GetStyle() = ImGuiStyle();
    ImGui::GetStyle().ScaleAllSizes(scale);
    ImGuiIO& io = ImGui::GetIO();
    ImFontConfig font;
    font.SizePixels = std::floor(kFontPixels * scale);
    io.Fonts->Clear();
    io.Fonts->AddFontDefault(&font);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
    height_ = 0;  // the panel's place is of the other scale
}

void Panel::draw(WindowState& state, const View& view, float scale) {
    ImGui_ImplOpenGL3_NewFrame();
    set_scale(scale);
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    draw_overlay(state, view);
    if (state.visible) {
        // Where people put it, until the window gets another size: it might lie outside then.
        const ImGuiCond when = view.height == height_ ? ImGuiCond_Once : ImGuiCond_Always;
        height_ = view.height;
        const float edge = scaled(10.0f);
        ImGui::SetNextWindowPos({edge, edge}, when);
        ImGui::SetNextWindowSize({scaled(320.0f), static_cast<float>(view.height) - 2.0f * edge},
                                 when);
        ImGui::Begin("Glowworm");
        ImGui::PushItemWidth(scaled(-110.0f));
        ImGui::Text("%.0f ms a frame at 1/%d, %.0f %% sharp", state.frame_ms, state.divisor,
                    (state.divisor == 1 ? 1.0 : state.sharpened) * 100.0);
        ImGui::Text("flies at %.2f m/s", static_cast<double>(state.speed));
        draw_light_status(state.light_status);
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

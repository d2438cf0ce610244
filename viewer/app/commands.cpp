#include "viewer/app/commands.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace glowworm {
namespace {

enum class Where { kAnywhere, kSurveyOnly };

struct Binding {
    int key, modifiers;
    Where where;
    Command command;
    const char* name;
    const char* says;  ///< nullptr: another line of the help says it
};

constexpr int kShift = GLFW_MOD_SHIFT, kControl = GLFW_MOD_CONTROL;
using enum Command;
using enum Where;

constexpr Binding kBindings[] = {
    {GLFW_KEY_1, 0, kAnywhere, kFly, "1", "fly"},
    {GLFW_KEY_2, 0, kAnywhere, kOrbit, "2", "orbit; a double click sets the point"},
    {GLFW_KEY_3, 0, kAnywhere, kWalk, "3", "walk at head height over the floor"},
    {GLFW_KEY_P, 0, kAnywhere, kPlan, "P", "plan"},
    {GLFW_KEY_L, 0, kAnywhere, kElevation, "L", "elevation"},
    {GLFW_KEY_N, 0, kSurveyOnly, kFaceNorth, "N S E W", "plan and elevation: face that way"},
    {GLFW_KEY_S, 0, kSurveyOnly, kFaceSouth, "", nullptr},
    {GLFW_KEY_E, 0, kSurveyOnly, kFaceEast, "", nullptr},
    {GLFW_KEY_W, 0, kSurveyOnly, kFaceWest, "", nullptr},
    {GLFW_KEY_N, kShift, kAnywhere, kFaceNorth, "Shift+N S E W", "face that way, in every view"},
    {GLFW_KEY_S, kShift, kAnywhere, kFaceSouth, "", nullptr},
    {GLFW_KEY_E, kShift, kAnywhere, kFaceEast, "", nullptr},
    {GLFW_KEY_W, kShift, kAnywhere, kFaceWest, "", nullptr},
    {GLFW_KEY_SPACE, 0, kSurveyOnly, kRotate, "Space", "plan and elevation: rotate, stop"},
    {GLFW_KEY_DELETE, 0, kAnywhere, kReset, "Delete", "back to where it started"},
    {GLFW_KEY_H, 0, kAnywhere, kHeadlamp, "H", "headlamp on, off"},
    {GLFW_KEY_B, 0, kAnywhere, kAddLamp, "B", "add a lamp here"},
    {GLFW_KEY_B, kShift, kAnywhere, kPlaceLamp, "Shift+B", "add a lamp at the wall clicked next"},
    {GLFW_KEY_X, 0, kAnywhere, kRemoveLamp, "X", "remove the selected lamp"},
    {GLFW_KEY_Z, kControl, kAnywhere, kUndo, "Ctrl+Z", "undo what was done to lamps"},
    {GLFW_KEY_Y, kControl, kAnywhere, kRedo, "Ctrl+Y", "redo it"},
    {GLFW_KEY_Z, kControl | kShift, kAnywhere, kRedo, "", nullptr},
    {GLFW_KEY_S, kControl, kAnywhere, kSaveScene, "Ctrl+S", "save the scene"},
    {GLFW_KEY_O, kControl, kAnywhere, kLoadScene, "Ctrl+O", "load the scene"},
    {GLFW_KEY_M, 0, kAnywhere, kMeasureLeg, "M", "measure from point to point"},
    {GLFW_KEY_M, kShift, kAnywhere, kMeasurePolyline, "Shift+M", "measure along a line"},
    {GLFW_KEY_G, 0, kAnywhere, kMeasurePolygon, "G", "measure a polygon's area"},
    {GLFW_KEY_I, 0, kAnywhere, kMeterLight, "I", "light meter under the cursor"},
    {GLFW_KEY_ENTER, 0, kAnywhere, kFinishMeasuring, "Enter", "end the line or polygon"},
    {GLFW_KEY_M, kControl, kAnywhere, kSaveMeasurements, "Ctrl+M", "save the measurements"},
    {GLFW_KEY_K, 0, kAnywhere, kAddKeyframe, "K", "add a keyframe of a camera path"},
    {GLFW_KEY_K, kShift, kAnywhere, kPlayPath, "Shift+K", "play the path, stop"},
    {GLFW_KEY_K, kControl, kAnywhere, kSavePath, "Ctrl+K", "save the path"},
    {GLFW_KEY_F12, 0, kAnywhere, kSavePicture, "F12", "save the picture (PNG, EXR) and its scene"},
    {GLFW_KEY_TAB, 0, kAnywhere, kHidePanels, "Tab", "hide the panels"},
    {GLFW_KEY_F1, 0, kAnywhere, kShowKeys, "F1", "these keys"},
    {GLFW_KEY_ESCAPE, 0, kAnywhere, kClose, "Esc", "end measuring or placing; else close"},
};

}  // namespace

std::optional<Request> request_of_key(int key, int modifiers, MoveMode mode) {
    // Num Lock and Caps Lock do not count.
    const int held = modifiers & (kShift | kControl | GLFW_MOD_ALT | GLFW_MOD_SUPER);
    for (const Binding& binding : kBindings) {
        if (binding.key != key || binding.modifiers != held) continue;
        if (binding.where == kSurveyOnly && mode != MoveMode::kSurvey) continue;
        return Request{binding.command};
    }
    return std::nullopt;
}

std::string key_help(MoveMode mode) {
    std::string text;
    if (mode != MoveMode::kSurvey) {
        text +=
            "W A S D       ahead, left, back, right\n"
            "R F           up, down\n";
    }
    for (const Binding& binding : kBindings) {
        if (binding.says != nullptr) text += fmt::format("{:<14}{}\n", binding.name, binding.says);
    }
    return text;
}

}  // namespace glowworm

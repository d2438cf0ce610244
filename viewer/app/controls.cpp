#include "viewer/app/controls.h"

#include <initializer_list>

namespace glowworm {
namespace {

DragAction of_buttons(MouseButton button, DragAction left, DragAction right, DragAction middle) {
    return button == MouseButton::kLeft ? left : button == MouseButton::kRight ? right : middle;
}

const char* words_for(DragAction action) {
    switch (action) {
        case DragAction::kNone:
            return "nothing";
        case DragAction::kLook:
            return "look around";
        case DragAction::kOrbit:
            return "orbit round the point under the cursor";
        case DragAction::kPan:
            return "pan";
        case DragAction::kTurnZoom:
            return "turn (sideways), zoom (up, down)";
        case DragAction::kTilt:
            return "turn and tilt";
    }
    return "";
}

}  // namespace

DragAction drag_action(ControlScheme scheme, MoveMode mode, MouseButton button, bool shift) {
    using enum DragAction;
    if (shift && button == MouseButton::kLeft) return kPan;
    if (mode == MoveMode::kSurvey) {
        if (scheme == ControlScheme::kAven) return of_buttons(button, kTurnZoom, kPan, kTilt);
        return of_buttons(button, kPan, kTilt, kPan);
    }
    switch (scheme) {
        case ControlScheme::kFly:
            return of_buttons(button, mode == MoveMode::kOrbit ? kOrbit : kLook, kOrbit, kPan);
        case ControlScheme::kPotree:
            return of_buttons(button, mode == MoveMode::kOrbit ? kOrbit : kLook, kPan, kPan);
        case ControlScheme::kAven:
            return of_buttons(button, mode == MoveMode::kOrbit ? kTurnZoom : kLook, kPan, kOrbit);
        case ControlScheme::kCad:
            // The left button picks; the middle one turns, and pans with Shift.
            if (button == MouseButton::kMiddle) return shift ? kPan : kOrbit;
            return of_buttons(button, kNone, kPan, kOrbit);
    }
    return kNone;
}

WheelAction wheel_action(ControlScheme, MoveMode mode) {
    return mode == MoveMode::kFly || mode == MoveMode::kWalk ? WheelAction::kSpeed
                                                             : WheelAction::kDolly;
}

MoveMode first_mode(ControlScheme scheme) {
    switch (scheme) {
        case ControlScheme::kFly:
            return MoveMode::kFly;
        case ControlScheme::kPotree:
        case ControlScheme::kCad:
            return MoveMode::kOrbit;
        case ControlScheme::kAven:
            return MoveMode::kSurvey;
    }
    return MoveMode::kFly;
}

std::string mouse_help(ControlScheme scheme, MoveMode mode) {
    std::string text;
    const struct {
        MouseButton button;
        const char* name;
    } buttons[] = {{MouseButton::kLeft, "drag          "},
                   {MouseButton::kRight, "right drag    "},
                   {MouseButton::kMiddle, "middle drag   "}};
    for (const auto& b : buttons) {
        text += b.name;
        text += words_for(drag_action(scheme, mode, b.button, false));
        text += '\n';
    }
    text += wheel_action(scheme, mode) == WheelAction::kSpeed ? "wheel         speed; it stays\n"
                                                              : "wheel         nearer, farther\n";
    return text;
}

}  // namespace glowworm

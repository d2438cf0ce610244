#pragma once

#include <string>

namespace glowworm {

/// Whose habits the mouse follows.
enum class ControlScheme { kFly, kPotree, kAven, kCad };

inline constexpr const char* kControlNames[] = {"fly", "potree", "aven", "cad"};

/// How the camera moves.
enum class MoveMode {
    kFly,     ///< free, WASD
    kOrbit,   ///< round a point
    kWalk,    ///< at head height over the floor
    kSurvey,  ///< plan, elevation: a parallel projection
};

enum class MouseButton { kLeft, kRight, kMiddle };

/// What dragging the mouse does.
enum class DragAction {
    kNone,
    kLook,      ///< turns the head
    kOrbit,     ///< turns round the point under the cursor
    kPan,       ///< moves what is under the cursor along with it
    kTurnZoom,  ///< aven's left button: sideways turns, up and down zooms
    kTilt,      ///< aven's middle button
};

/// What the wheel does.
enum class WheelAction {
    kSpeed,  ///< sets the speed, which stays
    kDolly,  ///< comes nearer to the point under the cursor
};

DragAction drag_action(ControlScheme scheme, MoveMode mode, MouseButton button, bool shift);
WheelAction wheel_action(ControlScheme scheme, MoveMode mode);

/// The mode that a scheme starts in.
MoveMode first_mode(ControlScheme scheme);

/// "drag: look, right drag: orbit, ..." for the list of keys.
std::string mouse_help(ControlScheme scheme, MoveMode mode);

}  // namespace glowworm

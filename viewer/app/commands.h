#pragma once

#include <optional>
#include <string>
#include <vector>

#include "viewer/app/controls.h"

namespace glowworm {

/// What keys and panels ask the window to do.
enum class Command {
    kClose,
    kHidePanels,
    kShowKeys,
    kFly,
    kOrbit,
    kWalk,
    kPlan,
    kElevation,
    kFaceNorth,
    kFaceSouth,
    kFaceEast,
    kFaceWest,
    kRotate,
    kReset,
    kGoToStation,  ///< `which`: the station
    kHeadlamp,
    kAddLamp,    ///< at the camera; `which`: the preset
    kPlaceLamp,  ///< on the wall that is clicked next; `which`: the preset
    kAimLamp,    ///< the selected spot, at what is clicked next
    kRemoveLamp,
    kUndo,
    kRedo,
    kSaveScene,
    kLoadScene,
    kSavePicture,
    kMeasureLeg,
    kMeasurePolyline,
    kMeasurePolygon,
    kMeterLight,
    kFinishMeasuring,
    kSaveMeasurements,
    kAddKeyframe,
    kPlayPath,
    kSavePath,
    kGoToKeyframe,  ///< `which`: the keyframe
    kClipHere,      ///< the clip box round what is looked at
    kRebuildLight,  ///< other settings of how light is gathered
};

struct Request {
    Command command;
    int which = 0;
};

/// What a key asks for; GLFW_KEY_* and GLFW_MOD_*. Some letters mean another thing in a survey
/// view.
std::optional<Request> request_of_key(int key, int modifiers, MoveMode mode);

/// One line a key, for people.
std::string key_help(MoveMode mode);

}  // namespace glowworm

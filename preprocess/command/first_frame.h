#pragma once

#include <filesystem>
#include <string>

#include "preprocess/command/console.h"

namespace glowworm {

/// A picture of a cave from its first station, or why there is none.
struct FirstFrame {
    std::string png;      ///< content of a PNG; empty where it could not be drawn
    std::string why_not;  ///< one sentence then
};

/// Has the `glowworm-view` beside this program draw `octree` into `picture`, which is removed
/// again. `console` shows how far it is. A viewer that is not there, cannot draw or takes too long
/// is said in the result; throws Error (kCancelled) once the user has asked to stop.
FirstFrame draw_first_frame(const std::filesystem::path& octree,
                            const std::filesystem::path& picture, Console& console);

}  // namespace glowworm

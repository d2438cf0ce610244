#pragma once

#include <vector>

#include "viewer/app/cave.h"
#include "viewer/app/history.h"
#include "viewer/app/navigator.h"
#include "viewer/app/options.h"
#include "viewer/app/start.h"
#include "viewer/app/window_state.h"

namespace glowworm {

/// What a session begins with: a cave and flags, or all that there was when an earlier session
/// lost its graphics context.
struct Beginning {
    Start start;
    WindowState state;
    Navigator navigator;
    History<std::vector<Lamp>> history;
    bool resumed = false;
};

/// Throws Error as start_of does.
Beginning beginning_of(const Options& options, const Cave& cave);

}  // namespace glowworm

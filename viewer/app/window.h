#pragma once

#include "viewer/app/cave.h"
#include "viewer/app/options.h"

namespace glowworm {

/// Opens a window and flies through the cave until it is closed; light goes on propagating while it
/// draws. Throws Error (kInternal) where no display or no OpenGL 4.5 can be had.
void run_window(const Options& options, const Cave& cave);

}  // namespace glowworm

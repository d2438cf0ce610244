#pragma once

namespace CLI {
class App;
}

namespace glowworm {

struct SharedFlags;

/// Sets up what the program says on stderr, under --progress json as objects
/// {"log":LEVEL,"sentence":TEXT}, a line each like the progress between them, and, with --log-file,
/// in a file as well. Throws Error (kUsage) where that file is one the `command` was given for
/// something else, or holds a scan or an octree, (kUnreadable) where it cannot be written. A log
/// that cannot be written later, because the disk is full, is given up; the work goes on.
void set_up_log(const SharedFlags& flags, const CLI::App& command);

}  // namespace glowworm

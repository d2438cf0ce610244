#include "viewer/app/window.h"

#include "octree/error.h"
#include "viewer/app/session.h"

namespace glowworm {
namespace {

constexpr double kHopeless = 10.0;  // s: a context that was made anew and lasted no longer

/// Until the window is closed or another cave is dropped on it; a lost graphics context is made
/// anew.
SessionEnd look_at(const Options& options, const Cave& cave) {
    Beginning beginning = beginning_of(options, cave);
    while (true) {
        const bool resumed = beginning.resumed;
        const double begun = now_seconds();
        SessionEnd end = Session(options, cave, std::move(beginning)).run();
        if (!std::holds_alternative<Beginning>(end)) return end;
        if (resumed && now_seconds() - begun < kHopeless) {
            throw Error(ExitCode::kInternal,
                        "the graphics driver was reset again and again: update it, or give "
                        "--light-memory and --gpu-memory less than the graphics card has");
        }
        beginning = std::move(std::get<Beginning>(end));
    }
}

}  // namespace

void run_window(const Options& options, const Cave& cave) {
    SessionEnd end = look_at(options, cave);
    while (std::holds_alternative<NextCave>(end)) {
        // Scene and camera were the first cave's.
        const NextCave shown = std::move(std::get<NextCave>(end));
        Options again = options;
        again.octree = shown.path;
        again.scene.clear();
        again.camera.clear();
        end = look_at(again, shown.cave);
    }
}

}  // namespace glowworm

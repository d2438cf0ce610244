#include "viewer/app/window.h"

#include "viewer/app/session.h"

namespace glowworm {

void run_window(const Options& options, const Cave& cave) {
    std::optional<NextCave> next = Session(options, cave).run();
    while (next) {
        // Scene and camera were the first cave's.
        const NextCave shown = std::move(*next);
        Options again = options;
        again.octree = shown.path;
        again.scene.clear();
        again.camera.clear();
        next = Session(again, shown.cave).run();
    }
}

}  // namespace glowworm

#include "viewer/app/start.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "octree/error.h"
#include "viewer/app/default_scene.h"

namespace glowworm {

Start start_of(const OctreeView& octree, const std::filesystem::path& scene_file,
               const std::string& name) {
    Start start;
    start.scene = scene_file.empty() ? default_scene(octree) : read_scene(scene_file);
    if (start.scene.point_lights.empty() && start.scene.spot_lights.empty() &&
        start.scene.area_lights.empty()) {
        spdlog::warn("'{}' has no lights: all that does not shine by itself is black",
                     scene_file.string());
    }
    const std::vector<Camera>& cameras = start.scene.cameras;
    if (name.empty()) {
        start.camera = cameras.empty() ? default_scene(octree).cameras.front() : cameras.front();
        return start;
    }
    std::string names;
    for (const Camera& camera : cameras) {
        if (camera.name == name) {
            start.camera = camera;
            return start;
        }
        names += (names.empty() ? "" : ", ") + camera.name;
    }
    throw Error(ExitCode::kUsage,
                fmt::format("there is no camera '{}' in {}, which has {}", name,
                            scene_file.empty() ? "the scene made for want of --scene"
                                               : fmt::format("'{}'", scene_file.string()),
                            names.empty() ? "none" : names));
}

}  // namespace glowworm

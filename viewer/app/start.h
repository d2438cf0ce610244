#pragma once

#include <filesystem>
#include <string>

#include "octree/octree_file.h"
#include "octree/scene.h"

namespace glowworm {

/// What the viewer starts with.
struct Start {
    Scene scene;
    Camera camera;
};

/// Lights and cameras from `scene_file`, or our own where it is empty. The camera is the one called
/// `name`, the first where that is empty, and our own where the scene has none. Throws Error
/// (kUsage), with the names there are, for a camera that is not there.
Start start_of(const OctreeView& octree, const std::filesystem::path& scene_file,
               const std::string& name);

}  // namespace glowworm

#pragma once

#include <string>
#include <vector>

#include "octree/scene.h"

namespace glowworm {

/// A lamp of the scene as the panel shows it.
struct LampControl {
    std::string name;
    bool on = true;
    float brightness = 1.0f;  ///< factor on the scene's intensity or radiance, 0..
    float tint[3] = {1.0f, 1.0f, 1.0f};
};

/// One control for each of the scene's lights.
std::vector<LampControl> lamp_controls(const Scene& scene);

/// The scene with its lamps as the controls have them.
Scene controlled_scene(const Scene& scene, const std::vector<LampControl>& lamps);

}  // namespace glowworm

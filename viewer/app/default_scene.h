#pragma once

#include <optional>

#include "octree/octree_file.h"
#include "octree/scene.h"

namespace glowworm {

/// What a cave is looked at with when nobody brought a scene: the area lights it holds, a lamp at
/// each station, a headlamp, and one camera, inside the passage and looking along it. Lamps are
/// bright enough for about 1 W·m⁻² on the nearest walls; exposure does the rest.
Scene default_scene(const OctreeView& octree);

inline constexpr const char* kHeadlampName = "headlamp";

/// The lamp on the viewer's helmet: white, a little above the eye.
PointLight headlamp_at(const Camera& camera, float radiant_intensity);

/// Takes the headlamp out of a scene that has one.
struct Headlamp {
    Vec3d eye;                ///< m, world: the camera it belongs to
    float radiant_intensity;  ///< W·sr⁻¹
};
std::optional<Headlamp> take_headlamp(Scene& scene);

/// The area lights that an octree file carries.
std::vector<AreaLight> area_lights_of(const OctreeView& octree);

}  // namespace glowworm

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "octree/surfel.h"
#include "octree/vec3.h"

namespace glowworm {

/// Both programs read scene files: `glowworm build --lights` puts the area lights into the tree,
/// the viewer lights the cave with all of them.
struct PointLight {
    std::string name;
    Vec3d position;           ///< m, world
    Vec3f radiant_intensity;  ///< W·sr⁻¹
    std::string unknown;      ///< JSON object of the keys that are not ours, kept; empty: none
};

/// Toward an angle θ from its axis it sends radiant_intensity · cosθ · smoothstep(t),
/// t = (cosθ − cos(cone/2)) / ((1 − cos(cone/2)) · blend): Blender's spot.
struct SpotLight {
    std::string name;
    Vec3d position;           ///< m, world
    Vec3d direction;          ///< unit, world
    double cone_deg = 45.0;   ///< full angle
    double blend = 0.15;      ///< 0..1: the outer part of the cone that fades
    Vec3f radiant_intensity;  ///< W·sr⁻¹, on the axis
    std::string unknown;      ///< as a PointLight's
};

struct Camera {
    std::string name;
    Vec3d position, look_at;  ///< m, world
    Vec3d up{0.0, 0.0, 1.0};
    double vfov_deg = 60.0;
    int width = 800, height = 600;
    std::string unknown;  ///< as a PointLight's
};

struct Scene {
    std::vector<PointLight> point_lights;
    std::vector<SpotLight> spot_lights;
    std::vector<AreaLight> area_lights;
    std::vector<std::string> area_unknown;  ///< [area_lights] as PointLight::unknown, or empty
    std::vector<Camera> cameras;
    std::string unknown;  ///< of the file's own object
};

/// Reads a scene.json. Unknown keys are kept and ignored; a missing one, a wrong type or a number
/// that is not finite throws Error (kUnreadable) with a sentence that names the key and the light
/// or camera.
Scene read_scene(const std::filesystem::path& path);

/// The scene as a scene.json's text: read_scene reads the same back, unknown keys included.
std::string scene_json(const Scene& scene);

}  // namespace glowworm

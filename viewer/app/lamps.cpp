#include "viewer/app/lamps.h"

namespace glowworm {

std::vector<LampControl> lamp_controls(const Scene& scene) {
    std::vector<LampControl> controls;
    for (const PointLight& light : scene.point_lights)
        controls.push_back({light.name});
    for (const SpotLight& light : scene.spot_lights)
        controls.push_back({light.name});
    for (const AreaLight& light : scene.area_lights)
        controls.push_back({light.name});
    return controls;
}

Scene controlled_scene(const Scene& scene, const std::vector<LampControl>& lamps) {
    Scene lit = scene;
    std::size_t next = 0;
    const auto control = [&](Vec3f& power) {
        const LampControl& lamp = lamps[next++];
        const float factor = lamp.on ? lamp.brightness : 0.0f;
        for (int c = 0; c < 3; ++c)
            power[c] *= factor * lamp.tint[c];
    };
    for (PointLight& light : lit.point_lights)
        control(light.radiant_intensity);
    for (SpotLight& light : lit.spot_lights)
        control(light.radiant_intensity);
    for (AreaLight& light : lit.area_lights)
        control(light.radiance);
    return lit;
}

}  // namespace glowworm

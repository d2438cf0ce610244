#include "viewer/app/lamps.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "viewer/app/photometry.h"

namespace glowworm {
namespace {

constexpr LampPreset kPresets[] = {
    {"carbide lamp", LampKind::kPoint, 100.0, 2400.0, 60.0, 0.3},
    {"LED headlamp", LampKind::kSpot, 300.0, 5700.0, 45.0, 0.7},
    {"show-cave spot", LampKind::kSpot, 800.0, 3000.0, 35.0, 0.4},
    {"show-cave flood", LampKind::kSpot, 1500.0, 4000.0, 110.0, 0.5},
};

AreaLight area_light_of(const Lamp& lamp) {
    AreaLight light{lamp.name, {}, lamp.strength};
    std::copy(lamp.corners.begin(), lamp.corners.end(), light.corners);
    return light;
}

constexpr const char* kOnKey = "on";  // of a light in a scene file; true where it is absent

/// Takes the switch out of a light's unknown keys. What is no switch stays among them.
bool take_switch(std::string& unknown) {
    if (unknown.empty()) return true;
    nlohmann::json keys = nlohmann::json::parse(unknown);
    const auto found = keys.find(kOnKey);
    if (found == keys.end() || !found->is_boolean()) return true;
    const bool on = found->get<bool>();
    keys.erase(found);
    unknown = keys.empty() ? std::string() : keys.dump();
    return on;
}

std::string with_switch_off(const std::string& unknown) {
    auto keys = unknown.empty() ? nlohmann::json::object() : nlohmann::json::parse(unknown);
    keys[kOnKey] = false;
    return keys.dump();
}

/// The lights of `lamps` as they are, whether on or off.
Scene scene_of(const Scene& scene, std::span<const Lamp> lamps) {
    Scene of_lamps;
    of_lamps.cameras = scene.cameras;
    of_lamps.unknown = scene.unknown;
    for (const Lamp& lamp : lamps) {
        if (lamp.kind == LampKind::kPoint) {
            of_lamps.point_lights.push_back(
                {lamp.name, lamp.position, lamp.strength, lamp.unknown});
        } else if (lamp.kind == LampKind::kSpot) {
            of_lamps.spot_lights.push_back({lamp.name, lamp.position, lamp.direction, lamp.cone_deg,
                                            lamp.blend, lamp.strength, lamp.unknown});
        } else {
            of_lamps.area_lights.push_back(area_light_of(lamp));
            of_lamps.area_unknown.push_back(lamp.unknown);
        }
    }
    return of_lamps;
}

/// Watts of a lamp whose strength has luminance 1.
double power_of_unit(const Lamp& lamp) {
    switch (lamp.kind) {
        case LampKind::kPoint:
            return power_of(PointLight{"", {}, {1, 1, 1}});
        case LampKind::kSpot:
            return spot_solid_angle(lamp.cone_deg, lamp.blend);
        case LampKind::kArea: {
            AreaLight light = area_light_of(lamp);
            light.radiance = {1, 1, 1};
            return power_of(light);
        }
    }
    return 0.0;
}

}  // namespace

std::vector<Lamp> lamps_of(const Scene& scene) {
    std::vector<Lamp> lamps;
    for (const PointLight& light : scene.point_lights) {
        Lamp lamp{LampKind::kPoint, light.name};
        lamp.position = light.position;
        lamp.strength = light.radiant_intensity;
        lamp.unknown = light.unknown;
        lamps.push_back(lamp);
    }
    for (const SpotLight& light : scene.spot_lights) {
        Lamp lamp{LampKind::kSpot, light.name};
        lamp.position = light.position;
        lamp.direction = light.direction;
        lamp.cone_deg = light.cone_deg;
        lamp.blend = light.blend;
        lamp.strength = light.radiant_intensity;
        lamp.unknown = light.unknown;
        lamps.push_back(lamp);
    }
    for (std::size_t i = 0; i < scene.area_lights.size(); ++i) {
        const AreaLight& light = scene.area_lights[i];
        Lamp lamp{LampKind::kArea, light.name};
        std::copy(std::begin(light.corners), std::end(light.corners), lamp.corners.begin());
        for (const Vec3d& corner : light.corners)
            lamp.position += corner / 4.0;
        lamp.direction = light.normal();
        lamp.strength = light.radiance;
        if (i < scene.area_unknown.size()) lamp.unknown = scene.area_unknown[i];
        lamps.push_back(lamp);
    }
    for (Lamp& lamp : lamps)
        lamp.on = take_switch(lamp.unknown);
    return lamps;
}

Scene with_lamps(const Scene& scene, std::span<const Lamp> lamps) {
    std::vector<Lamp> lit(lamps.begin(), lamps.end());
    for (Lamp& lamp : lit) {
        if (!lamp.on) lamp.strength = {};
    }
    return scene_of(scene, lit);
}

Scene saved_with_lamps(const Scene& scene, std::span<const Lamp> lamps) {
    std::vector<Lamp> saved(lamps.begin(), lamps.end());
    for (Lamp& lamp : saved) {
        if (!lamp.on) lamp.unknown = with_switch_off(lamp.unknown);
    }
    return scene_of(scene, saved);
}

double power_of(const Lamp& lamp) {
    return power_of_unit(lamp) * luminance_of(lamp.strength);
}

Vec3f strength_for(const Lamp& lamp, double watts) {
    const double luminance = luminance_of(lamp.strength);
    const Vec3f color =
        luminance > 0 ? lamp.strength / static_cast<float>(luminance) : Vec3f{1, 1, 1};
    return color * static_cast<float>(watts / power_of_unit(lamp));
}

void set_color(Lamp& lamp, const Vec3f& color) {
    const double wanted = luminance_of(color);
    if (!(wanted > 0)) return;
    lamp.strength = color * static_cast<float>(luminance_of(lamp.strength) / wanted);
}

std::span<const LampPreset> lamp_presets() {
    return kPresets;
}

Lamp lamp_from(const LampPreset& preset, const Vec3d& position, const Vec3d& direction) {
    Lamp lamp{preset.kind, preset.name};
    lamp.position = position;
    lamp.direction = normalized(direction, Vec3d{0, 0, -1});
    lamp.cone_deg = preset.cone_deg;
    lamp.blend = preset.blend;
    lamp.strength = color_of_temperature(preset.kelvin);
    lamp.strength = strength_for(lamp, preset.lumens / kLuminousEfficacy);
    return lamp;
}

std::string free_name(std::span<const Lamp> lamps, const std::string& wanted) {
    const auto taken = [&](const std::string& name) {
        return std::any_of(lamps.begin(), lamps.end(),
                           [&](const Lamp& lamp) { return lamp.name == name; });
    };
    std::string name = wanted;
    for (int number = 2; taken(name); ++number)
        name = wanted + " " + std::to_string(number);
    return name;
}

}  // namespace glowworm

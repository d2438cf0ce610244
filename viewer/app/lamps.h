#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "octree/scene.h"

namespace glowworm {

enum class LampKind { kPoint, kSpot, kArea };

/// A light of the scene as the window edits it, whatever its kind.
struct Lamp {
    LampKind kind = LampKind::kPoint;
    std::string name;
    bool on = true;
    Vec3d position;                ///< m, world; an area light's middle, which stays
    Vec3d direction{0, 0, -1};     ///< unit; of spots
    double cone_deg = 60.0;        ///< full angle, (0, 180]; of spots
    double blend = 0.3;            ///< 0..1; of spots
    Vec3f strength{1, 1, 1};       ///< W·sr⁻¹, of area lights W·sr⁻¹·m⁻²
    std::array<Vec3d, 4> corners;  ///< of area lights: samples of the octree, so they cannot move
    std::string unknown;           ///< the scene file's other keys

    friend bool operator==(const Lamp&, const Lamp&) = default;
};

/// Points, spots, areas, in the scene's order; off are those whose file says `"on": false`.
std::vector<Lamp> lamps_of(const Scene& scene);

/// The lights of `lamps`; those that are off are there and dark. Cameras stay `scene`'s.
Scene with_lamps(const Scene& scene, std::span<const Lamp> lamps);

/// The same to be saved: those that are off keep their strength and say `"on": false`.
Scene saved_with_lamps(const Scene& scene, std::span<const Lamp> lamps);

/// Watts that leave the lamp when it is on, and the strength that so many watts take.
double power_of(const Lamp& lamp);
Vec3f strength_for(const Lamp& lamp, double watts);

/// The lamp in another colour (linear Rec.709) of the same power.
void set_color(Lamp& lamp, const Vec3f& color);

/// What a caver or a show cave brings.
struct LampPreset {
    const char* name;
    LampKind kind;
    double lumens, kelvin, cone_deg, blend;
};
std::span<const LampPreset> lamp_presets();

/// A lamp of a preset at a place, a spot's axis along `direction`.
Lamp lamp_from(const LampPreset& preset, const Vec3d& position, const Vec3d& direction);

/// `wanted`, or with a number behind it where a lamp has that name.
std::string free_name(std::span<const Lamp> lamps, const std::string& wanted);

}  // namespace glowworm

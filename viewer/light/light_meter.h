#pragma once

#include <span>
#include <vector>

#include "octree/vec3.h"
#include "viewer/light/light_field.h"

namespace glowworm {

/// A surface point to measure light at.
struct Probe {
    Vec3d position;  ///< m, world
    Vec3f normal;    ///< unit
};

/// Irradiance, W·m⁻².
struct ProbeResult {
    Vec3f direct;            ///< straight from a light
    Vec3f indirect;          ///< reflected at least once
    bool on_surface = true;  ///< false: no surface that faces its way is near, and indirect is 0
};

/// The light meter: of each probe what a frame would show there, by the same lookup and shadows.
std::vector<ProbeResult> measure_light(const LightField& light, std::span<const Probe> probes);

}  // namespace glowworm

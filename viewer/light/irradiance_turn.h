#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "octree/link_directions.h"
#include "viewer/gpu/vec4.h"

namespace glowworm {

/// How irradiance changes as a surface turns, by the light that arrives along its rays (Ward and
/// Heckbert 1992, Irradiance Gradients): the twin of light_gradient.comp, where the bounds are.
class IrradianceTurn {
  public:
    static constexpr float kLeastCosine = 0.1f;

    /// `radiance` arrives along ray number `ray` of a lobe with this unit normal.
    void add(std::uint32_t lobe, std::uint32_t ray, const Vec3f& normal,
             const gpu::vec4& radiance) {
        const Vec3f direction = link_direction(lobe, ray, normal);
        const float cosine = dot(direction, normal);
        add((direction - cosine * normal) / std::max(cosine, kLeastCosine), to_vec3(radiance));
    }

    /// `radiance` arrives along rays that turn irradiance by `along`.
    void add(const Vec3f& along, const Vec3f& radiance) {
        for (int c = 0; c < 3; ++c)
            turn_[c] += along * radiance[c];
    }

    /// What lookups read of a surface with that irradiance and wall (walls.h), `open_rays` of whose
    /// rays are not buried, among rock of the radiance `around`.
    gpu::LobeLight light(const gpu::vec4& irradiance, std::uint32_t wall, float open_rays,
                         const Vec3f& around) const {
        gpu::LobeLight light;
        light.irradiance = {irradiance.x, irradiance.y, irradiance.z, static_cast<float>(wall)};
        const float scale = kPi / open_rays;
        for (int c = 0; c < 3; ++c) {
            const Vec3f scaled = turn_[c] * scale;
            light.turn[c] = {scaled.x, scaled.y, scaled.z, kPi * around[c]};
        }
        return light;
    }

  private:
    static constexpr float kPi = std::numbers::pi_v<float>;

    Vec3f turn_[3];  // per channel
};

}  // namespace glowworm

#pragma once

#include <span>
#include <vector>

#include "viewer/gpu/lanes.h"

namespace glowworm::gpu {

/// The lobes in the leaves round a point, found once for all points between the same leaf centres
/// and kept side by side for as many points as come there.
class LobesNear {
  public:
    /// kLanes lobes. Past the last one they lie in a leaf that is near nothing.
    struct Group {
        Floats cell[3];  ///< leaf edges: their leaves' lower corners
        Vec3s position;  ///< m
        Vec3s normal;
        uint lobe[kLanes];
    };
    /// A LobeLight, the channels of what it adds up to in lanes.
    struct Light {
        Floats irradiance;  ///< w: as LobeLight's
        Floats along[3];    ///< what tilting the normal along each axis adds
        Floats around;      ///< LobeLight::turn's w
    };
    struct Lobes {
        ivec3 low{0}, high{-1};
        std::vector<Group> groups;
        std::vector<Light> lights;  ///< [lobes]
    };

    LobesNear(std::span<const Node> nodes, std::span<const Lobe> lobes,
              std::span<const LobeLight> lights, int depth);

    /// Those in the leaves from `low` to `high`, both included. Valid until the next call.
    const Lobes& in_leaves(ivec3 low, ivec3 high);

  private:
    void find(Lobes& found) const;
    void add(uint lobe, vec3 position, vec3 normal, ivec3 cell, Lobes& found) const;

    std::span<const Node> nodes_;
    std::span<const Lobe> lobes_;
    std::span<const LobeLight> lights_;
    int depth_;
    std::vector<Lobes> kept_;  // each where its leaves' place says
};

}  // namespace glowworm::gpu

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octree/vec3.h"

namespace glowworm {

/// A scanner set-up in the world: where a scan was taken from, kept so that normals can face it and
/// a viewer can start there.
struct Station {
    Vec3d position;                             ///< m, world
    double rotation[4] = {0.0, 0.0, 0.0, 1.0};  ///< T_world_scan's rotation, quaternion x y z w
    bool has_viewpoint = true;  ///< false: a SLAM or merged cloud, seen from many places
    std::string name;           ///< file name of the scan
};

/// A rectangle that emits `radiance` from the side from which its corners run counter-clockwise.
struct AreaLight {
    std::string name;
    Vec3d corners[4];  ///< m, world
    Vec3f radiance;    ///< W·sr⁻¹·m⁻², linear Rec.709

    /// Unit normal of the emitting side.
    Vec3d normal() const {
        return normalized(cross(corners[1] - corners[0], corners[3] - corners[0]));
    }
};

/// A surface element: what the octree is built from.
struct Surfel {
    Vec3f position;             ///< m, relative to the cloud's origin
    Vec3f normal;               ///< unit, toward the passage
    float radius = 0.0f;        ///< m; the disc it stands for has area pi·radius²
    float ndf_length = 1.0f;    ///< Toksvig length in (0, 1]: 1 is mirror-flat
    Vec3f albedo;               ///< linear Rec.709, 0..1
    Vec3f emission;             ///< radiance, W·sr⁻¹·m⁻²
    std::uint32_t station = 0;  ///< index into SurfelCloud::stations
    std::uint32_t light = 0;    ///< 0: none, else 1 + index into SurfelCloud::area_lights
};

struct SurfelCloud {
    Vec3d origin;  ///< m, world; surfel positions are relative to it
    std::vector<Surfel> surfels;
    std::vector<Station> stations;
    std::vector<AreaLight> area_lights;
};

}  // namespace glowworm

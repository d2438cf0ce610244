#pragma once

#include <filesystem>
#include <vector>

#include "octree/scene.h"
#include "octree/surfel.h"

namespace glowworm::testing {

/// A lit scene of data/gi with known light: its README says how it was made.
struct GiScene {
    struct Truth {
        Vec3d position;  ///< m
        Vec3f normal;
        Vec3d direct;    ///< W·m⁻²
        Vec3d indirect;  ///< W·m⁻²
    };
    SurfelCloud cloud;  ///< points as given, area lights put in
    Scene scene;
    std::vector<Truth> probes;
};

GiScene read_gi_scene(const std::filesystem::path& folder);

/// Mean over probes and channels of |measured - true| / max(true, 2 % of the scene's mean).
double mean_relative_error(const std::vector<Vec3d>& measured, const std::vector<Vec3d>& truth);

}  // namespace glowworm::testing

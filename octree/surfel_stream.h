#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "octree/surfel.h"

namespace glowworm {

/// A cloud that need not be in memory: `for_each` hands over all surfels in batches, the same ones
/// in the same order every time it is called. A batch is valid only during the call.
struct SurfelStream {
    Vec3d origin;  ///< m, world; surfel positions are relative to it
    std::vector<Station> stations;
    std::vector<AreaLight> area_lights;
    std::function<void(const std::function<void(std::span<const Surfel>)>& batch)> for_each;
    std::uint64_t expected = 0;  ///< surfels to make room for; 0: not known
    std::uint64_t dropped =
        0;  ///< left out before they came here; counted with those dropped later
};

}  // namespace glowworm

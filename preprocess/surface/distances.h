#pragma once

#include <cstddef>
#include <cstdint>

#include "octree/vec3.h"

namespace glowworm {

/// Arrays of squared distances are padded to a multiple of this, so that loops have no rest.
inline constexpr std::size_t kLanes = 16;

inline std::size_t pad(std::size_t size) {
    return (size + kLanes - 1) / kLanes * kLanes;
}

/// Squared distances ([size], m²) of the points x, y, z ([size] each, m) to `from`.
void measure_distances(const float* __restrict x, const float* __restrict y,
                       const float* __restrict z, std::size_t size, Vec3f from,
                       float* __restrict distance2);

/// Writes where distances are within the bound, ascending; `size` is a multiple of kLanes.
std::size_t places_within(const float* distance2, std::size_t size, float bound,
                          std::uint32_t* places);

/// A squared distance within which at least `wanted` of the `size` distances are, exactly `wanted`
/// unless some are equal, given one that is enough and a guess (0: none). `enough` where fewer are.
float bound_of(const float* distance2, std::size_t size, std::size_t wanted, float enough,
               float guess);

}  // namespace glowworm

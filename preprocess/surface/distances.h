#pragma once

#include <cstddef>
#include <cstdint>

#include "octree/vec3.h"

namespace glowworm {

/// Arrays of coordinates and distances are padded to a multiple of this, so that loops have no
/// rest.
inline constexpr std::size_t kLanes = 8;

inline std::size_t pad(std::size_t size) {
    return (size + kLanes - 1) / kLanes * kLanes;
}

/// Writes which of the points x, y, z ([size] each, m; a multiple of kLanes) lie within the bound
/// (m²) of `from`, ascending, and their squared distances. Both arrays have room for size + kLanes.
std::size_t find_within(const float* x, const float* y, const float* z, std::size_t size,
                        Vec3f from, float bound2, std::uint32_t* places, float* distance2);

/// Writes into `order` which of the distances is the smallest, the next, and so on: [size], equal
/// ones as they stand. `distance2` and `ranks` (for its own use) have room for pad(size). Time
/// O(size²), of some hundred at most.
void order_distances(float* distance2, std::size_t size, std::uint32_t* ranks,
                     std::uint32_t* order);

}  // namespace glowworm

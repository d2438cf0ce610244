#pragma once

#include <cstdint>

#include "octree/octree.h"

namespace glowworm {

/// The same surface with leaves at a coarser level: the lobes of a cell's leaves are joined as
/// samples are when a leaf is built, weighted by their areas. For simulating light at less than a
/// file's depth. Chunks, surfels and links are left empty: points are drawn from the file itself.
/// `depth` at or above the octree's own gives a copy without them. `octree` must be sound.
Octree coarsen(const OctreeView& octree, std::uint32_t depth);

}  // namespace glowworm

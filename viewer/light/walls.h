#pragma once

#include <cstdint>
#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

/// [lobes] 1 + the lobe of a wall that rises beside each and hides surface that lies nearly in its
/// plane: the floor of the next room. Lookups keep the light of the two apart. The nearest such
/// wall, within three leaf edges; 0: none. The same on any number of threads.
std::vector<std::uint32_t> walls_beside(const OctreeView& octree);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

/// [lobes] 1 + the lobe of a wall that rises beside each and hides surface that lies nearly in its
/// plane: the floor of the next room. Lookups keep the light of the two apart. The nearest such
/// wall, within three leaf edges; 0: none. The same on any number of threads.
std::vector<std::uint32_t> walls_beside(const OctreeView& octree);

/// Lobes from `first` to before `last`.
struct LobeRange {
    std::uint32_t first = 0, last = 0;
};

/// The same for some of the lobes; `walls` has a place for every one.
void find_walls_beside(const OctreeView& octree, std::span<const LobeRange> ranges,
                       std::span<std::uint32_t> walls);

}  // namespace glowworm

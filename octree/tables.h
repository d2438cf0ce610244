#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "octree/octree.h"
#include "octree/surfel.h"

namespace glowworm {

/// Writes stations, area lights and their names into the octree's tables. Throws Error (kUsage) for
/// more than 65535 of either: a surfel has 16 bits for each.
void write_tables(std::span<const Station> stations, std::span<const AreaLight> lights,
                  Octree& octree);

/// The tables as they were before packing; a name outside the names section reads as empty.
std::vector<Station> read_stations(const OctreeView& octree);
std::vector<AreaLight> read_area_lights(const OctreeView& octree);

}  // namespace glowworm

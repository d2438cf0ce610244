#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

/// An octree in memory, owning what an OctreeView points to. Fields as there.
struct Octree {
    Grid grid;
    Vec3f bounds_min, bounds_max;
    std::uint64_t sample_count = 0;
    std::uint64_t dropped_count = 0;
    std::vector<Level> levels;
    std::vector<Node> nodes;
    std::vector<NodeAttributes> attributes;
    std::vector<Lobe> lobes;
    std::vector<Chunk> chunks;
    std::vector<PackedSurfel> surfels;
    std::vector<StationRecord> stations;
    std::vector<AreaLightRecord> area_lights;
    std::string names;
    std::string provenance;            ///< JSON; the command that builds fills it in
    std::vector<std::uint32_t> links;  ///< empty until baked
    std::uint32_t links_per_lobe = 0;

    OctreeView view() const {
        return {grid,        bounds_min, bounds_max, sample_count, dropped_count, levels,
                nodes,       attributes, lobes,      chunks,       surfels,       stations,
                area_lights, names,      provenance, links,        links_per_lobe};
    }
};

}  // namespace glowworm

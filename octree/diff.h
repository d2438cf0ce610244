#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

struct SectionDifference {
    std::string section;  ///< "nodes", "lobes", ...
    std::uint64_t count_a = 0, count_b = 0;
    std::uint64_t differing = 0;  ///< of the records that both have by place
    std::uint64_t first = 0;      ///< the first of them
};

/// Nodes of a level matched by their cells.
struct LevelDifference {
    std::uint32_t level = 0;
    std::uint64_t only_a = 0, only_b = 0, both = 0;
    double largest_opacity = 0.0;  ///< largest differences among the cells both have
    double largest_albedo = 0.0;
    double largest_ndf = 0.0;           ///< length of the vectors' difference
    double area_a = 0.0, area_b = 0.0;  ///< m², of the whole level
};

struct OctreeDifference {
    std::vector<std::string> header;          ///< sentences: depth, grid, counts that differ
    std::vector<SectionDifference> sections;  ///< those that differ
    /// All levels that both have, with differences or not; empty for different root cubes, whose
    /// cells do not correspond.
    std::vector<LevelDifference> levels;

    bool identical() const { return header.empty() && sections.empty(); }
};

/// What differs between two sound octrees. Identical octrees have no header or section differences.
OctreeDifference compare_octrees(const OctreeView& a, const OctreeView& b);

}  // namespace glowworm

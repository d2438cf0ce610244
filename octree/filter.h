#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "octree/grid.h"
#include "octree/node_layout.h"
#include "octree/progress.h"

namespace glowworm {

/// What a leaf of edge `voxel` m holds on the whole. Its opacity is the part of the cross-section
/// that its surface covers, Σ A·|n|₁ / h² bounded by 1: h² / |n|₁ is the mean area of a plane with
/// normal n inside the voxels it crosses. Never a count of points.
NodeAttributes leaf_attributes(std::span<const Lobe> lobes, float voxel);

/// A parent from its children, null where there is none. Area adds up, normal and albedo are
/// area-weighted means, so that totals are the same at every level. Opacity is that of the axis
/// along which most is covered: children behind each other add up to at most 1, the four columns
/// average.
NodeAttributes filter_node(const std::array<const NodeAttributes*, 8>& children);

struct NodeTree {
    std::vector<Level> levels;               ///< [depth + 1]
    std::vector<Node> nodes;                 ///< breadth-first
    std::vector<NodeAttributes> attributes;  ///< parallel to nodes
};

/// All levels over the leaves. `leaf_codes`: [leaves] Morton codes at the grid's depth, ascending;
/// `lobe_counts`: [leaves] 1..3; `lobes`: in the leaves' order. No leaves: no tree.
/// `progress` counts levels, each found once and filtered once.
/// Throws Error (kBudget) for more nodes or lobes than 32 bits count.
NodeTree build_nodes(const Grid& grid, std::span<const std::uint64_t> leaf_codes,
                     std::span<const std::uint8_t> lobe_counts, std::span<const Lobe> lobes,
                     const Progress& progress = {});

}  // namespace glowworm

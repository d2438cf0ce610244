#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "octree/octree_file.h"
#include "preprocess/plot/picture.h"

namespace glowworm {

/// How the nodes of a level are spread: opacity and NDF length in 20 bins over 0..1, and how many
/// children an inner node has (lobes a leaf), 1 to 8.
struct LevelHistograms {
    std::uint64_t nodes = 0;
    std::array<std::uint64_t, 20> opacity{}, ndf_length{};
    std::array<std::uint64_t, 8> children{};
};

/// [depth + 1], from the root down. Reads nothing outside the spans, whatever they hold.
std::vector<LevelHistograms> measure_levels(const OctreeView& octree);

/// A row for each level, a panel for each histogram. Each panel says how many nodes its highest bar
/// stands for, and over what its bars lie.
Picture plot_levels(const std::vector<LevelHistograms>& levels);

}  // namespace glowworm

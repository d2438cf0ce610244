#pragma once

#include <cstdint>
#include <filesystem>

#include "octree/cloud_summary.h"
#include "octree/grid.h"

namespace glowworm {

/// What building takes in memory, measured with some room.
inline constexpr std::uint64_t kBytesPerSurfel = 240;  ///< with a leaf to each
inline constexpr std::uint64_t kBytesPerLeaf = 260;    ///< node, attributes, lobes and their copies
inline constexpr std::uint64_t kBytesPerNode = 70;     ///< of those above the leaves
inline constexpr std::uint64_t kOwnBytes = 24'000'000;  ///< blocks being read, threads, joining

/// What an octree will hold, take on disk (links left out) and take in memory while it is built at
/// once.
struct SizeEstimate {
    double leaves = 0.0, nodes = 0.0;
    std::uint64_t disk = 0, memory = 0;
};

/// From the samples whose radii the summary keeps. Where leaves are far smaller than the samples'
/// distance each sample's disc fills leaves of its own, up to one a piece of its splat, each below
/// a chain of nodes with one child: deep octrees of wide discs take 100 kB a sample. Samples
/// without radius count as points.
SizeEstimate estimate_size(const CloudSummary& summary, const Grid& grid);

/// Throws Error (kBudget) where the octree's file will surely not fit on the disk that `path` is
/// on: before any work. The sentence names a depth that fits.
void require_room(const CloudSummary& summary, const Grid& grid, const std::filesystem::path& path);

}  // namespace glowworm

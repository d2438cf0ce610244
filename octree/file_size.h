#pragma once

#include <cstdint>
#include <filesystem>

#include "octree/cloud_summary.h"
#include "octree/grid.h"

namespace glowworm {

/// What an octree will hold and take on disk, links left out.
struct SizeEstimate {
    double leaves = 0.0, nodes = 0.0;
    std::uint64_t bytes = 0;
};

/// From the median sample alone, so the less exact the more the samples differ. Where leaves are
/// far smaller than the samples' distance each sample's disc fills leaves of its own, up to one a
/// piece of its splat, each below a chain of nodes with one child: deep octrees of wide discs take
/// thousands of bytes a sample. Samples without radius count as points.
SizeEstimate estimate_size(const CloudSummary& summary, const Grid& grid);

/// Throws Error (kBudget) where the disk that `path` will be on has less room than half of what is
/// estimated: sure not to do, before any work.
void require_room(const SizeEstimate& estimate, const std::filesystem::path& path);

}  // namespace glowworm

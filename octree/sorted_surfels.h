#pragma once

#include <vector>

#include "octree/cloud_summary.h"
#include "octree/grid.h"
#include "octree/radix_sort.h"
#include "octree/surfel.h"
#include "octree/unfilled.h"

namespace glowworm {

/// The usable surfels of a cloud in the order of their Morton codes, equal ones as they came.
struct SortedSurfels {
    Unfilled<Surfel> surfels;
    CodeIndices codes;  ///< [surfels] at level 21, ascending; `index` counts from 0 on
};

/// `summary` is of `surfels`, which are given back on the way. A radius that is missing becomes the
/// median of those that are there, else one from the samples' spacing, which the summary is told.
SortedSurfels sort_surfels(std::vector<Surfel> surfels, const Grid& grid, CloudSummary& summary);

/// Radius of a sample's share of the surface, m, from the spacing of all usable surfels.
double radius_from_spacing(std::span<const Surfel> surfels, const Grid& grid,
                           const CloudSummary& summary);

}  // namespace glowworm

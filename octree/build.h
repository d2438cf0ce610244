#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "octree/cloud_summary.h"
#include "octree/morton.h"
#include "octree/octree.h"
#include "octree/progress.h"
#include "octree/sorted_surfels.h"
#include "octree/surfel.h"

namespace glowworm {

/// Where the leaves go. With neither depth nor voxel size the leaves become the smallest that still
/// hold `samples_per_face` samples for each voxel face of surface.
struct BuildSettings {
    std::optional<std::uint32_t> depth = {};  ///< level of the leaves, 0..21
    std::optional<double> voxel_size = {};    ///< m, > 0: edge of a leaf
    double samples_per_face = 3.5;  ///< > 0: light needs 4 to 8, and 3.5 in the median gives that
    std::uint32_t deepest_automatic = 11;  ///< leaves beyond this only when asked for
    /// A grid fixed elsewhere, for tiles of one cave; then the fields above are not looked at. What
    /// lies outside is moved to the cube's side.
    std::optional<Grid> grid = {};
    /// Only this cell of `grid`, which must be given and at least as deep: its points and leaves,
    /// and what discs from outside lay into them. Tiles join to the same bytes as one build; each
    /// counts what was dropped of the points it was given.
    std::optional<OctreeCell> tile = {};
    std::string provenance = "{}";  ///< JSON to keep in the file: command, version, inputs
};

/// The root cube, 1/32 larger than the bounds and centred on them, and the depth. Throws Error
/// (kUsage) where depth and voxel size do not fit each other or the bounds.
Grid fit_grid(const CloudSummary& summary, const Vec3d& origin, const BuildSettings& settings);

/// Throws Error (kUsage) where `settings.tile` is not a cell of `settings.grid`.
void require_tile(const BuildSettings& settings);

/// Gives samples without a radius one: the median of those that have it, else from the spacing.
/// Before samples of another kind join a cloud: afterwards theirs would be taken for the cloud's.
void fill_missing_radii(SurfelCloud& cloud);

/// An octree whose points are sorted but not packed yet.
struct UnpackedOctree {
    Octree octree;  ///< all but chunks and surfels
    SortedSurfels sorted;
    std::span<const CodeIndex> own = {};  ///< of sorted.codes: the points in the tile
};

/// All of build_octree but packing the points; `summary` is of the cloud's surfels.
UnpackedOctree build_tree(SurfelCloud cloud, CloudSummary summary, const BuildSettings& settings,
                          const Progress& progress);

/// Builds the octree: sort by Morton code, splat into leaves, filter up, pack the points. The same
/// cloud gives the same bytes on any number of threads. Hand the cloud over where it is not needed
/// any more: its surfels are given back while the tree is built. Surfels that are not finite are
/// dropped and counted; a radius that is not positive is replaced by one from the samples' spacing.
/// Throws Error (kDegenerate) for a cloud without a usable surfel, (kUsage) for settings that
/// cannot be met.
Octree build_octree(SurfelCloud cloud, const BuildSettings& settings = {},
                    const Progress& progress = {});

}  // namespace glowworm

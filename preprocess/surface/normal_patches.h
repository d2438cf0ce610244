#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/surface/normals.h"

namespace glowworm {

inline constexpr std::uint32_t kNoPatch = 0xffffffffu;

/// Points that lie near each other and whose normals belong together, some of them turned.
struct NormalPatches {
    std::size_t count = 0;
    std::vector<std::uint32_t> of;  ///< [n] patch << 1 | opposite to it; kNoPatch without a normal
};

/// What says that two patches have the same side (> 0) or opposite ones (< 0), and how loudly.
struct PatchLink {
    std::uint32_t a = 0, b = 0;
    float agreement = 0.0f;
};

/// Patches of at most some thousand points: Kruskal's spanning trees over the table's neighbours,
/// the surest first (Hoppe et al. 1992), each block of the Morton order by itself and in parallel,
/// so that memory and the reach of a mistake are bounded. Whether two normals agree is asked of the
/// arc through both points (König and Gumhold 2009), which also turns the corner of an edge and
/// knows the two sides of a thin sheet apart; `noise`, m, is the distance below which the direction
/// between two points says nothing.
NormalPatches make_normal_patches(const SurfacePoints& points, const NeighbourTable& table,
                                  const std::vector<LocalPlane>& planes, float noise);

/// The links that neighbouring points make between patches, a < b, summed and sorted.
std::vector<PatchLink> link_neighbours(const SurfacePoints& points, const NeighbourTable& table,
                                       const std::vector<LocalPlane>& planes,
                                       const NormalPatches& patches, float noise);

/// Sums the links of each pair, a < b, in an order that does not depend on theirs.
std::vector<PatchLink> sum_links(std::vector<PatchLink> links);

/// Joins the patches by their loudest links first, the links of what was joined adding up. Returns
/// for each of `count` patches its component << 1 | opposite to it.
std::vector<std::uint32_t> join_patches(std::size_t count, const std::vector<PatchLink>& links);

}  // namespace glowworm

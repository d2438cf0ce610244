#pragma once

#include <cstdint>
#include <vector>

#include "octree/octree_file.h"
#include "octree/progress.h"
#include "octree/trace.h"

namespace glowworm {

/// Light arrives at a lobe along a fixed set of cosine-distributed rays. A ray's link is the lobe
/// that it meets; as long as nothing moves, a bounce of light is a product over the links.
struct LinkSettings {
    std::uint32_t rays = 128;  ///< per lobe, 1..1024
    TraceSettings trace = {};
};

/// The direction of a lobe's ray number `ray`: a point of the R2 sequence (Roberts 2018), shifted
/// by a hash of the lobe (Cranley-Patterson) and mapped to the cosine round `normal`. In fixed
/// point, so that it is the same on every machine. `normal` is unit.
Vec3f link_direction(std::uint32_t lobe, std::uint32_t ray, const Vec3f& normal);

/// [lobes x settings.rays] hit lobes, kNoHit or kBuried, on all cores; the same on any number of them. Rays
/// of a lobe are consecutive and the first n of them are a good set for every n. `progress` counts
/// lobes and may throw to cancel.
std::vector<std::uint32_t> trace_links(const OctreeView& octree, const LinkSettings& settings,
                                       const Progress& progress = {});

}  // namespace glowworm

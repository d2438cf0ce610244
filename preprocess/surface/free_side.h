#pragma once

#include <vector>

#include "preprocess/surface/normal_patches.h"

namespace glowworm {

/// What rays that leave the patches on both sides found.
struct SideEvidence {
    /// Two surfaces that see each other both show their free side or both their hidden one.
    std::vector<PatchLink> links;

    /// [patches] Per side, the front being that of the patch: rays that ended on a surface, those
    /// that left the cloud, and how far the former went, m.
    struct Side {
        double hits = 0.0, escapes = 0.0, distance = 0.0;
    };
    std::vector<Side> front, back;
};

/// Casts rays from points spread evenly over the patches through the cloud's discs. Time bounded by
/// some hundred thousand rays; in parallel.
SideEvidence look_around(const SurfacePoints& points, const std::vector<LocalPlane>& planes,
                         const NormalPatches& patches);

}  // namespace glowworm

#pragma once

#include "preprocess/surface/point_tree.h"

namespace glowworm {

/// What a sample of the points says about all of them.
struct CloudScale {
    float reach = 0.0f;        ///< m: 95 % of the points have their `k` neighbours within it
    float range_noise = 0.0f;  ///< m: standard deviation of the points across the surface
};

/// Looks at some thousand points spread evenly over the cloud. The noise is what remains of
/// neighbourhoods of `k` points after a quadric is fitted: curvature is not noise, and of what is
/// left the lower quartile is taken (and scaled to the median's place by the chi distribution), so
/// that edges, plants and roughness finer than the spacing are not either. Zero for an empty cloud.
CloudScale measure_scale(const PointTree& tree, int k);

}  // namespace glowworm

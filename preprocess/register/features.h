#pragma once

#include "preprocess/register/scan_model.h"

namespace glowworm {

/// Keypoints on a grid of twice the samples' spacing, each with the Fast Point Feature Histogram of
/// the samples within six spacings (Rusu et al. 2009), as square roots, so that their Euclidean
/// distance is the Hellinger distance of the histograms. Those with too few samples around them to
/// describe are left out.
Keypoints describe(const SurfaceSamples& samples);

}  // namespace glowworm

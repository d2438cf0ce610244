#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/register/scan_model.h"

namespace glowworm {

/// A keypoint of the source that looks like one of the target.
struct Correspondence {
    std::uint32_t source, target;  ///< indices of keypoints
    float distance;                ///< of the descriptors
};

/// Pairs of keypoints that are among each other's `nearest` most alike, exact (no tree helps in 33
/// dimensions), best first, at most `max_count`.
std::vector<Correspondence> match(const Keypoints& source, const Keypoints& target,
                                  std::size_t nearest = 1, std::size_t max_count = 3000);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/surfel.h"

namespace glowworm {

/// What the samples of a cloud say before anything is built.
struct CloudSummary {
    Vec3f bounds_min, bounds_max;  ///< m, relative to the cloud's origin; zero where none is usable
    std::uint64_t usable = 0;      ///< surfels that will be built from
    std::uint64_t dropped = 0;     ///< not finite, or without a normal
    bool needs_repair = false;     ///< a radius is missing or a value out of its range
    bool radius_missing = false;
    std::vector<float> radii = {};  ///< m, of some usable surfels, spread evenly over them
    double median_radius = 0.0;     ///< m, of those that have one; 0 where none has

    /// Area of the median sample, as the edge of a square, m.
    double median_spacing() const;
};

/// Collects a summary from batches, however the cloud is cut into them. The median is taken over
/// every 2^k-th surfel, at most 65536 of them.
class CloudSummarizer {
  public:
    void add(std::span<const Surfel> batch);
    CloudSummary finish() const;

  private:
    CloudSummary sum_;
    std::vector<float> radii_;  ///< of every stride_-th surfel, NaN where it has none
    std::uint64_t stride_ = 1;
    std::uint64_t seen_ = 0;
};

CloudSummary summarize(std::span<const Surfel> surfels);

/// Finite, with a normal.
bool is_usable(const Surfel& surfel);

/// Brings a usable surfel's values into their ranges; a missing radius becomes `default_radius`.
void repair(Surfel& surfel, double default_radius);

}  // namespace glowworm

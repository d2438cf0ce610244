#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "preprocess/read/read_scans.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// What one look at a scan's points tells, gathered block by block in memory that does not depend
/// on their number.
struct ScanFacts {
    ScanCounts counts;
    Vec3d low, high;  ///< m, bounds in the scan's frame
    bool has_colours = false;
    Rgb8 darkest, brightest;       ///< least and greatest value of each channel
    double duplicate_share = 0.0;  ///< of the points, those at the place of an earlier one; sampled
    std::uint64_t grid_rows = 0, grid_columns = 0;  ///< as far as points reach; 0: not organised
    bool on_float_grid = true;                      ///< every coordinate is a 32-bit float
    double spacing = 0.0;                           ///< m, see median_spacing; 0 where unknown
    bool has_pose = false;
    std::string crs;
};

/// Gathers the facts of a scan, `facts.counts` and what is known before the points excepted.
class FactsCollector {
  public:
    /// Points that are finite, relative to `origin`.
    void add(const PointBlock& block, const Vec3d& origin);

    /// Writes what was gathered to `facts`.
    void finish(ScanFacts& facts);

    /// Up to 64 points spread over all that were added, the same ones for the same points.
    std::vector<Vec3d> spread_points() const;

  private:
    std::uint64_t points_ = 0;
    Vec3d low_, high_;
    bool has_colours_ = false, on_float_grid_ = true;
    std::uint64_t grid_rows_ = 0, grid_columns_ = 0;
    Rgb8 darkest_{255, 255, 255}, brightest_{0, 0, 0};
    // Points whose hash is at most the limit: equal points are in or out together.
    std::vector<std::uint64_t> sampled_hashes_;
    std::uint64_t hash_limit_ = UINT64_MAX;
    std::vector<std::pair<std::uint64_t, Vec3d>> spread_;  // those with the least hashes, a heap
};

/// Distances to nearest neighbours: the median over some points of a scan, given all of its points.
class SpacingCollector {
  public:
    explicit SpacingCollector(std::vector<Vec3d> queries);
    void add(const std::vector<Vec3d>& positions, const Vec3d& origin);

    /// m; a neighbour at the same place does not count; 0 where no point has another one.
    double median() const;

  private:
    std::vector<Vec3d> queries_;
    std::vector<double> squared_;  // to the nearest so far
};

/// The facts of a scan in memory; `counts` as read_scans reported them.
ScanFacts facts_of(const Scan& scan, const ScanCounts& counts);

}  // namespace glowworm

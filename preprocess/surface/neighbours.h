#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "preprocess/surface/point_tree.h"

namespace glowworm {

inline constexpr std::uint32_t kNoNeighbour = std::numeric_limits<std::uint32_t>::max();

/// The nearest other points of a few points that lie close together, found in one walk of the tree.
/// A thread keeps one and reuses its memory.
class NearestSearch {
  public:
    explicit NearestSearch(const PointTree& tree) : tree_(&tree) {}

    /// Finds for each of `queries` (indices into the tree, best those of one leaf) its `count`
    /// nearest other points within `radius` (m, the bound included), ties by smaller index.
    void search(std::span<const std::uint32_t> queries, int count, float radius);

    /// The neighbours of queries[i] in the last search, nearest first; fewer where there are fewer.
    std::span<const std::uint32_t> found(std::size_t i) const {
        return {indices_.data() + i * stride_, found_[i]};
    }

  private:
    struct Range {
        std::uint32_t begin, end;
        Vec3f low, high;
    };

    void collect_ranges(const Vec3f& low, const Vec3f& high, float reach2, Range window);
    void scan(std::uint32_t query, std::uint32_t begin, std::uint32_t end, std::size_t keep);

    const PointTree* tree_;
    std::size_t stride_ = 0;
    std::vector<std::uint32_t> indices_;  // [queries x stride_]
    std::vector<std::size_t> found_;      // [queries]
    std::vector<float> bound2_of_;        // [queries]

    // Candidates of one query: squared distance in the upper half, index in the lower, so that
    // numbers order as (distance, index) do. Distances are not negative, so their bits order them.
    std::vector<std::uint64_t> keys_;
    std::size_t candidates_ = 0;
    float bound2_ = 0.0f;
    std::vector<std::uint64_t> nearest_;  // [queries x stride_] from the window
    std::vector<float> distance2_;        // [block]
    std::vector<Range> ranges_;
    std::vector<std::uint32_t> stack_;
};

/// The `count` nearest other points of every point, in tree order, row-major [n x count], nearest
/// first, filled up with kNoNeighbour. In parallel.
std::vector<std::uint32_t> nearest_neighbours(const PointTree& tree, int count, float radius);

}  // namespace glowworm

#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "preprocess/surface/point_tree.h"

namespace glowworm {

inline constexpr std::uint32_t kNoNeighbour = std::numeric_limits<std::uint32_t>::max();

/// Exact nearest neighbours of points that lie close together, as those of a leaf do: the points
/// that can be neighbours of any of them are gathered once, side by side, and then every one of
/// them measures all. A thread keeps one and reuses its memory.
class NearestSearch {
  public:
    explicit NearestSearch(const PointTree& tree) : tree_(&tree) {}

    /// Gathers the points among which are, for each of `queries` (indices into the tree, at least
    /// one), the `count` nearest others within `radius` (m, the bound included).
    void gather(std::span<const std::uint32_t> queries, int count, float radius);

    /// Measures one of the gathered queries for the calls of `nearest` that follow.
    void measure(std::uint32_t query);

    /// The `count` nearest others (at most those gathered for) of the measured point, ties by
    /// smaller index, in the order of the tree, or all within the radius where they are fewer.
    /// Valid until the next call.
    std::span<const std::uint32_t> nearest(int count);

    /// How many were gathered.
    std::size_t gathered() const { return gathered_; }

    /// The `count` nearest of those that were found last, in the order of the tree.
    std::span<const std::uint32_t> nearest_of_those(int count);

    /// As `nearest`, nearest first.
    std::span<const std::uint32_t> nearest_in_order(int count);

  private:
    struct Range {
        std::uint32_t begin, end;
    };

    void collect_ranges(const Vec3f& low, const Vec3f& high, float reach2);
    void select(int count);
    void drop_surplus(std::size_t count);
    std::span<const std::uint32_t> listed();
    bool is_nearer(std::uint32_t a, std::uint32_t b) const;

    const PointTree* tree_;
    float radius2_ = 0.0f;
    std::uint32_t query_ = 0;
    float area_per_point_ = 0.0f;       // m², of the last search: where to start the next
    std::vector<float> x_, y_, z_;      // the gathered points, padded with infinity
    std::vector<std::uint32_t> index_;  // where they are in the tree
    std::size_t gathered_ = 0;          // without the padding
    std::size_t padded_ = 0;
    std::vector<float> distance2_;       // from query_ to the gathered points
    std::vector<std::uint32_t> chosen_;  // places among the gathered
    std::size_t chosen_count_ = 0;
    std::vector<float> near_;            // distances of the chosen
    std::vector<std::uint32_t> result_;  // indices into the tree
    std::vector<Range> ranges_;
    std::vector<std::uint32_t> stack_;
};

/// Calls `visit(i, search)` once for every point i of the tree, `search` measured for it and
/// gathered for `count` neighbours within `radius` metres. In parallel: of several points at once.
template <typename Visit>
void for_each_neighbourhood(const PointTree& tree, int count, float radius, const Visit& visit) {
    const tbb::blocked_range<std::size_t> leaves(0, tree.leaves.size(), 64);
    tbb::parallel_for(leaves, [&](const auto& range) {
        NearestSearch search(tree);
        std::vector<std::uint32_t> queries;
        for (std::size_t l = range.begin(); l < range.end(); ++l) {
            const PointTree::Node& leaf = tree.nodes[tree.leaves[l]];
            queries.resize(leaf.count);
            std::iota(queries.begin(), queries.end(), leaf.first);
            search.gather(queries, count, radius);
            for (const std::uint32_t i : queries) {
                search.measure(i);
                visit(i, search);
            }
        }
    });
}

/// The `count` nearest other points of every point, in tree order, row-major [n x count], nearest
/// first, filled up with kNoNeighbour. In parallel.
std::vector<std::uint32_t> nearest_neighbours(const PointTree& tree, int count, float radius);

}  // namespace glowworm

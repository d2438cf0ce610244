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

/// The points nearest to a point, nearest first, of equally near ones the smaller index first.
struct Neighbours {
    std::span<const std::uint32_t> index;  ///< [n] in the tree

    /// m: from the point to itself (zero), then to its neighbours, [1 + n].
    const float *x = nullptr, *y = nullptr, *z = nullptr;

    std::size_t size() const { return index.size(); }

    /// The `count` nearest of them, or all.
    Neighbours first(std::size_t count) const {
        return {index.first(std::min(count, index.size())), x, y, z};
    }
};

/// Exact nearest neighbours of points that lie close together, as those of a leaf do: the points
/// around them are gathered once, side by side, and then every one of them measures all. A thread
/// keeps one and reuses its memory.
class NearestSearch {
  public:
    explicit NearestSearch(const PointTree& tree) : tree_(&tree) {}

    /// Calls `visit(query, neighbours)` for each of `queries` (indices into the tree), in any
    /// order, with its `count` nearest others within `radius` (m, the bound included), or all that
    /// are. They are valid until `visit` returns.
    template <typename Visit>
    void visit_nearest(std::span<const std::uint32_t> queries, int count, float radius,
                       const Visit& visit) {
        if (queries.empty()) return;
        begin(count, radius);
        const Window run = window_of(queries);
        gather(queries, expected_reach2(run));
        missed_.clear();
        for (const std::uint32_t query : queries) {
            if (find(query)) {
                visit(query, found());
            } else {
                missed_.push_back(query);
            }
        }
        if (missed_.empty()) return;
        gather(missed_, sure_reach2(missed_, run));
        for (const std::uint32_t query : missed_) {
            find(query);
            visit(query, found());
        }
    }

  private:
    struct Window {
        std::uint32_t begin, end;
    };

    void begin(int count, float radius);
    Window window_of(std::span<const std::uint32_t> queries) const;
    float expected_reach2(Window run);
    float sure_reach2(std::span<const std::uint32_t> queries, Window run);
    void gather(std::span<const std::uint32_t> queries, float reach2);
    void collect_windows(const Vec3f& low, const Vec3f& high, float reach2);
    bool find(std::uint32_t query);
    std::size_t thin(std::size_t near, std::size_t wanted);
    Neighbours found() const {
        return {{index_.data(), found_}, dx_.data(), dy_.data(), dz_.data()};
    }

    const PointTree* tree_;
    std::size_t count_ = 0;
    float radius2_ = 0.0f;
    float reach2_ = 0.0f;          // m²: all points this near to the queries are gathered
    float area_per_point_ = 0.0f;  // m²: of the last query, for where to start the next
    float largest_area_ = 0.0f;    // m²: the same, the largest of the last visit's queries

    std::vector<Window> windows_;  // that are gathered
    std::vector<std::uint32_t> stack_, missed_;
    std::vector<float> x_, y_, z_;         // the gathered points, padded with infinity
    std::vector<std::uint32_t> gathered_;  // where they are in the tree
    std::size_t size_ = 0;                 // with the padding

    std::vector<std::uint32_t> places_, ranks_, order_;  // near ones among the gathered
    std::vector<float> distance2_;

    std::size_t found_ = 0;
    std::vector<std::uint32_t> index_;
    std::vector<float> dx_, dy_, dz_;
};

/// Calls `visit(i, neighbours)` once for every point i of the tree with its `count` nearest others
/// within `radius` metres. In parallel: of several points at once.
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
            search.visit_nearest(queries, count, radius, visit);
        }
    });
}

/// The `count` nearest other points of every point, in tree order, row-major [n x count], nearest
/// first, filled up with kNoNeighbour. In parallel.
std::vector<std::uint32_t> nearest_neighbours(const PointTree& tree, int count, float radius);

}  // namespace glowworm

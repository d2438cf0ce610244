#include "preprocess/surface/neighbours.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <numeric>

namespace glowworm {
namespace {

constexpr std::uint32_t kBlock = 256;

float gap2(float low_a, float high_a, float low_b, float high_b) {
    const float gap = std::max(std::max(low_a - high_b, low_b - high_a), 0.0f);
    return gap * gap;
}

/// Squared distance between two boxes. Rounding is monotonic, so it never exceeds the distance
/// computed between points of theirs.
float box_distance2(const Vec3f& low_a, const Vec3f& high_a, const Vec3f& low_b,
                    const Vec3f& high_b) {
    return gap2(low_a.x, high_a.x, low_b.x, high_b.x) + gap2(low_a.y, high_a.y, low_b.y, high_b.y) +
           gap2(low_a.z, high_a.z, low_b.z, high_b.z);
}

std::uint64_t make_key(float distance2, std::uint32_t index) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(distance2)} << 32 | index;
}

float key_distance2(std::uint64_t key) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32));
}

}  // namespace

/// Adds the points of [begin, end) within the bound to the candidates; when they are many, keeps
/// the `keep` nearest and lowers the bound to the last of them.
void NearestSearch::scan(std::uint32_t query, std::uint32_t begin, std::uint32_t end,
                         std::size_t keep) {
    const float qx = tree_->x[query], qy = tree_->y[query], qz = tree_->z[query];
    for (std::uint32_t block = begin; block < end; block += kBlock) {
        const std::uint32_t size = std::min(kBlock, end - block);
        const float* x = tree_->x.data() + block;
        const float* y = tree_->y.data() + block;
        const float* z = tree_->z.data() + block;
        float* distance2 = distance2_.data();
        for (std::uint32_t i = 0; i < size; ++i) {
            const float dx = x[i] - qx, dy = y[i] - qy, dz = z[i] - qz;
            distance2[i] = dx * dx + dy * dy + dz * dz;
        }
        std::uint64_t* keys = keys_.data();
        std::size_t count = candidates_;
        for (std::uint32_t i = 0; i < size; ++i) {
            keys[count] = make_key(distance2[i], block + i);
            count += (distance2[i] <= bound2_) & (block + i != query);
        }
        candidates_ = count;
        if (candidates_ > keep + kBlock) {
            std::nth_element(keys, keys + keep - 1, keys + candidates_);
            candidates_ = keep;
            bound2_ = key_distance2(keys[keep - 1]);
        }
    }
}

/// The leaves within `reach2` of a box, without the points of `window`.
void NearestSearch::collect_ranges(const Vec3f& low, const Vec3f& high, float reach2,
                                   Range window) {
    ranges_.clear();
    stack_.assign(1, 0);
    while (!stack_.empty()) {
        const PointTree::Node& node = tree_->nodes[stack_.back()];
        stack_.pop_back();
        const std::uint32_t end = node.first + node.count;
        if (node.first >= window.begin && end <= window.end) continue;
        if (box_distance2(low, high, node.low, node.high) > reach2) continue;
        if (node.children > 0) {
            for (std::uint32_t c = node.children; c-- > 0;)
                stack_.push_back(node.first_child + c);
            continue;
        }
        if (node.first < window.begin) {
            ranges_.push_back({node.first, std::min(end, window.begin), node.low, node.high});
        }
        if (end > window.end) {
            ranges_.push_back({std::max(node.first, window.end), end, node.low, node.high});
        }
    }
}

void NearestSearch::search(std::span<const std::uint32_t> queries, int count, float radius) {
    const auto keep = static_cast<std::size_t>(std::max(count, 0));
    const std::size_t n = queries.size();
    stride_ = keep;
    indices_.resize(n * keep);
    nearest_.resize(n * keep);
    found_.assign(n, 0);
    bound2_of_.assign(n, 0.0f);
    if (n == 0 || keep == 0) return;
    keys_.resize(keep + 2 * kBlock);
    distance2_.resize(kBlock);
    const float radius2 = radius * radius;

    // First the points around the queries in Morton order: they bound how far the walk must reach.
    const auto [first, last] = std::minmax_element(queries.begin(), queries.end());
    const auto reach = static_cast<std::uint32_t>(keep);
    const auto total = static_cast<std::uint32_t>(tree_->size());
    const Range window{*first > reach ? *first - reach : 0,
                       total - *last > reach ? *last + 1 + reach : total,
                       {},
                       {}};
    Vec3f low = tree_->position(queries[0]), high = low;
    float reach2 = 0.0f;
    for (std::size_t i = 0; i < n; ++i) {
        low = component_min(low, tree_->position(queries[i]));
        high = component_max(high, tree_->position(queries[i]));
        candidates_ = 0;
        bound2_ = radius2;
        scan(queries[i], window.begin, std::min(window.end, total), keep);
        if (candidates_ >= keep) {
            std::nth_element(keys_.begin(), keys_.begin() + static_cast<std::ptrdiff_t>(keep) - 1,
                             keys_.begin() + static_cast<std::ptrdiff_t>(candidates_));
            candidates_ = keep;
            bound2_ = key_distance2(keys_[keep - 1]);
        }
        std::copy_n(keys_.begin(), candidates_,
                    nearest_.begin() + static_cast<std::ptrdiff_t>(i * keep));
        found_[i] = candidates_;
        bound2_of_[i] = bound2_;
        reach2 = std::max(reach2, bound2_);
    }

    collect_ranges(low, high, reach2, window);

    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f position = tree_->position(queries[i]);
        candidates_ = found_[i];
        bound2_ = bound2_of_[i];
        std::copy_n(nearest_.begin() + static_cast<std::ptrdiff_t>(i * keep), candidates_,
                    keys_.begin());
        for (const Range& range : ranges_) {
            if (box_distance2(position, position, range.low, range.high) > bound2_) continue;
            scan(queries[i], range.begin, range.end, keep);
        }
        const auto candidates = keys_.begin() + static_cast<std::ptrdiff_t>(candidates_);
        found_[i] = std::min(candidates_, keep);
        const auto end = keys_.begin() + static_cast<std::ptrdiff_t>(found_[i]);
        if (candidates_ > keep) std::nth_element(keys_.begin(), end - 1, candidates);
        std::sort(keys_.begin(), end);
        for (std::size_t j = 0; j < found_[i]; ++j) {
            indices_[i * keep + j] = static_cast<std::uint32_t>(keys_[j]);
        }
    }
}

std::vector<std::uint32_t> nearest_neighbours(const PointTree& tree, int count, float radius) {
    const auto stride = static_cast<std::size_t>(count);
    std::vector<std::uint32_t> rows(tree.size() * stride, kNoNeighbour);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, tree.leaves.size(), 64), [&](const auto& range) {
            NearestSearch search(tree);
            std::vector<std::uint32_t> queries;
            for (std::size_t l = range.begin(); l < range.end(); ++l) {
                const PointTree::Node& leaf = tree.nodes[tree.leaves[l]];
                queries.resize(leaf.count);
                std::iota(queries.begin(), queries.end(), leaf.first);
                search.search(queries, count, radius);
                for (std::size_t i = 0; i < queries.size(); ++i) {
                    std::ranges::copy(search.found(i), rows.begin() + static_cast<std::ptrdiff_t>(
                                                                          queries[i] * stride));
                }
            }
        });
    return rows;
}

}  // namespace glowworm

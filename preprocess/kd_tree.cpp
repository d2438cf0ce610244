#include "preprocess/kd_tree.h"

#include <algorithm>
#include <array>

namespace glowworm {
namespace {

constexpr std::uint32_t kLeafPoints = 12;

}  // namespace

KdTree::KdTree(std::span<const Vec3f> points) {
    indices_.reserve(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (is_finite(points[i])) indices_.push_back(i);
    }
    if (indices_.empty()) return;
    nodes_.reserve(2 * indices_.size() / kLeafPoints + 1);
    build(0, static_cast<std::uint32_t>(indices_.size()), points);
    points_.resize(indices_.size());
    for (std::size_t i = 0; i < indices_.size(); ++i)
        points_[i] = points[indices_[i]];
}

void KdTree::build(std::uint32_t begin, std::uint32_t end, std::span<const Vec3f> points) {
    const std::size_t self = nodes_.size();
    nodes_.push_back({.begin = begin, .end = end});
    if (end - begin <= kLeafPoints) {
        std::sort(indices_.begin() + begin, indices_.begin() + end);
        return;
    }
    Vec3f low = points[indices_[begin]], high = low;
    for (std::uint32_t i = begin; i < end; ++i) {
        low = component_min(low, points[indices_[i]]);
        high = component_max(high, points[indices_[i]]);
    }
    const Vec3f extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0
                     : extent.y >= extent.z                       ? 1
                                                                  : 2;
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(indices_.begin() + begin, indices_.begin() + middle, indices_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                         const float pa = points[a][axis], pb = points[b][axis];
                         return pa < pb || (pa == pb && a < b);
                     });
    nodes_[self].axis = static_cast<std::uint32_t>(axis);
    nodes_[self].split = points[indices_[middle]][axis];
    build(begin, middle, points);
    nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
    build(middle, end, points);
}

/// Calls `visit(position, squared_distance)` for points not farther than `bound`, which `visit`
/// may lower. Depth is at most log2(2³² / leaf), so the stack is bounded.
template <typename Visit>
void KdTree::search(const Vec3f& query, float& bound, Visit visit) const {
    if (nodes_.empty() || !is_finite(query)) return;
    struct Pending {
        std::uint32_t node;
        float distance;  // squared, from the query to the node's cell
        float side[3];   // squared, per axis
    };
    std::array<Pending, 64> stack;
    std::size_t size = 0;
    stack[size++] = {0, 0.0f, {0.0f, 0.0f, 0.0f}};
    while (size > 0) {
        Pending at = stack[--size];
        if (at.distance > bound) continue;
        while (nodes_[at.node].axis != 3) {
            const Node& node = nodes_[at.node];
            const float offset = query[static_cast<int>(node.axis)] - node.split;
            const std::uint32_t left = at.node + 1;
            Pending far = at;
            far.node = offset < 0 ? node.right : left;
            far.distance += offset * offset - far.side[node.axis];
            far.side[node.axis] = offset * offset;
            if (far.distance <= bound) stack[size++] = far;
            at.node = offset < 0 ? left : node.right;
        }
        const Node& leaf = nodes_[at.node];
        for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
            const Vec3f d = points_[i] - query;
            const float squared = dot(d, d);
            if (squared <= bound) visit(i, squared);
        }
    }
}

Neighbour KdTree::nearest(const Vec3f& query, float max_distance) const {
    Neighbour best;
    float bound = max_distance * max_distance;
    search(query, bound, [&](std::uint32_t i, float squared) {
        if (squared < best.squared_distance ||
            (squared == best.squared_distance && indices_[i] < best.index)) {
            best = {indices_[i], squared};
            bound = squared;
        }
    });
    return best;
}

std::size_t KdTree::nearest(const Vec3f& query, std::span<Neighbour> result,
                            float max_distance) const {
    if (result.empty()) return 0;
    float bound = max_distance * max_distance;
    std::size_t found = 0;
    const auto before = [](const Neighbour& a, const Neighbour& b) {
        return a.squared_distance < b.squared_distance ||
               (a.squared_distance == b.squared_distance && a.index < b.index);
    };
    search(query, bound, [&](std::uint32_t i, float squared) {
        const Neighbour candidate{indices_[i], squared};
        if (found == result.size() && !before(candidate, result[found - 1])) return;
        std::size_t place = found < result.size() ? found++ : found - 1;
        for (; place > 0 && before(candidate, result[place - 1]); --place) {
            result[place] = result[place - 1];
        }
        result[place] = candidate;
        if (found == result.size()) bound = result[found - 1].squared_distance;
    });
    return found;
}

}  // namespace glowworm

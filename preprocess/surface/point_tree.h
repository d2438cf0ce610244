#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "octree/vec3.h"

namespace glowworm {

/// Points in Morton order under a tree of boxes. Points that lie near each other lie near each
/// other in memory, and each node is a contiguous range of them.
struct PointTree {
    struct Node {
        Vec3f low, high;          ///< m: the box of its points
        std::uint32_t first = 0;  ///< its points are [first, first + count)
        std::uint32_t count = 0;
        std::uint32_t first_child = 0;  ///< 0: a leaf
        std::uint32_t children = 0;     ///< 0..8, contiguous
    };

    std::vector<std::uint32_t> order;   ///< [n] index in the input of each point
    std::vector<float> x, y, z;         ///< [n] m
    std::vector<Node> nodes;            ///< root first; empty where there are no points
    std::vector<std::uint32_t> leaves;  ///< nodes that are leaves, in Morton order
    std::size_t not_finite = 0;         ///< points left out: not finite or beyond kFarthest
    std::size_t duplicates = 0;         ///< points left out: equal to one with a smaller index

    std::size_t size() const { return order.size(); }
    Vec3f position(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// Coordinates beyond this are taken as broken, m.
inline constexpr float kFarthest = 1e7f;

/// Points per leaf: few enough to measure all, enough to share one walk down the tree.
inline constexpr std::uint32_t kLeafPoints = 48;

/// Sorts and boxes `positions` (fewer than 2^32). Empty in, empty out. Time O(n log n), in
/// parallel.
PointTree make_point_tree(std::span<const Vec3f> positions);

}  // namespace glowworm

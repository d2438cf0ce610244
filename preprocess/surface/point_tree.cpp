#include "preprocess/surface/point_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "octree/morton.h"

namespace glowworm {
namespace {

struct Key {
    std::uint64_t code;
    std::uint32_t index;
};

bool is_usable(const Vec3f& p) {
    return std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest;
}

/// Morton keys of the usable points. Cells are cubes, 2^21 along the longest side.
std::vector<Key> morton_keys(std::span<const Vec3f> positions) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    Vec3f low{kInf, kInf, kInf}, high = -low;
    std::vector<Key> keys;
    keys.reserve(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!is_usable(positions[i])) continue;
        low = component_min(low, positions[i]);
        high = component_max(high, positions[i]);
        keys.push_back({0, static_cast<std::uint32_t>(i)});
    }
    const Vec3d size = vec3_cast<double>(high) - vec3_cast<double>(low);
    const double edge = std::max({size.x, size.y, size.z, 1e-30});
    const double scale = 2097151.0 / edge;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, keys.size()), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Vec3d cell =
                (vec3_cast<double>(positions[keys[i].index]) - vec3_cast<double>(low)) * scale;
            keys[i].code = morton_encode({static_cast<std::uint32_t>(cell.x),
                                          static_cast<std::uint32_t>(cell.y),
                                          static_cast<std::uint32_t>(cell.z)});
        }
    });
    return keys;
}

/// Splits [first, first + count) by the highest bits in which its codes differ; points of one cell,
/// which codes cannot part, are halved.
void split(std::span<const Key> keys, std::uint32_t first, std::uint32_t count,
           std::vector<PointTree::Node>& children) {
    const auto add = [&](std::uint32_t begin, std::uint32_t end) {
        PointTree::Node child;
        child.first = begin;
        child.count = end - begin;
        if (child.count > 0) children.push_back(child);
    };
    const std::uint32_t last = first + count - 1;
    const std::uint64_t differing = keys[first].code ^ keys[last].code;
    if (differing == 0) {
        add(first, first + count / 2);
        add(first + count / 2, first + count);
        return;
    }
    const int shift = (63 - std::countl_zero(differing)) / 3 * 3;
    std::uint32_t begin = first;
    while (begin <= last) {
        const std::uint64_t prefix = keys[begin].code >> shift;
        const auto end =
            std::partition_point(keys.begin() + begin, keys.begin() + last + 1,
                                 [&](const Key& k) { return k.code >> shift <= prefix; });
        const auto stop = static_cast<std::uint32_t>(end - keys.begin());
        add(begin, stop);
        begin = stop;
    }
}

void bound_leaf(const PointTree& tree, PointTree::Node& node) {
    node.low = node.high = tree.position(node.first);
    for (std::uint32_t i = node.first + 1; i < node.first + node.count; ++i) {
        node.low = component_min(node.low, tree.position(i));
        node.high = component_max(node.high, tree.position(i));
    }
}

/// Breadth-first, so that children lie behind their parent and boxes can be joined backwards.
void build_nodes(std::span<const Key> keys, PointTree& tree) {
    PointTree::Node root;
    root.count = static_cast<std::uint32_t>(keys.size());
    tree.nodes = {root};
    std::vector<PointTree::Node> children;
    for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
        if (tree.nodes[n].count <= kLeafPoints) {
            tree.leaves.push_back(static_cast<std::uint32_t>(n));
            continue;
        }
        children.clear();
        split(keys, tree.nodes[n].first, tree.nodes[n].count, children);
        tree.nodes[n].first_child = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes[n].children = static_cast<std::uint32_t>(children.size());
        tree.nodes.insert(tree.nodes.end(), children.begin(), children.end());
    }
    std::sort(tree.leaves.begin(), tree.leaves.end(), [&](std::uint32_t a, std::uint32_t b) {
        return tree.nodes[a].first < tree.nodes[b].first;
    });
    tbb::parallel_for(std::size_t{0}, tree.leaves.size(),
                      [&](std::size_t i) { bound_leaf(tree, tree.nodes[tree.leaves[i]]); });
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
        PointTree::Node& node = tree.nodes[n];
        if (node.children == 0) continue;
        node.low = tree.nodes[node.first_child].low;
        node.high = tree.nodes[node.first_child].high;
        for (std::uint32_t c = node.first_child; c < node.first_child + node.children; ++c) {
            node.low = component_min(node.low, tree.nodes[c].low);
            node.high = component_max(node.high, tree.nodes[c].high);
        }
    }
}

}  // namespace

PointTree make_point_tree(std::span<const Vec3f> positions) {
    PointTree tree;
    std::vector<Key> keys = morton_keys(positions);
    tree.not_finite = positions.size() - keys.size();
    if (keys.empty()) return tree;

    // Within one cell by coordinates, so that equal points meet, the first of the input ahead.
    tbb::parallel_sort(keys.begin(), keys.end(), [&](const Key& a, const Key& b) {
        if (a.code != b.code) return a.code < b.code;
        const Vec3f& p = positions[a.index];
        const Vec3f& q = positions[b.index];
        if (p.x != q.x) return p.x < q.x;
        if (p.y != q.y) return p.y < q.y;
        if (p.z != q.z) return p.z < q.z;
        return a.index < b.index;
    });
    const auto end = std::unique(keys.begin(), keys.end(), [&](const Key& a, const Key& b) {
        return a.code == b.code && positions[a.index] == positions[b.index];
    });
    tree.duplicates = static_cast<std::size_t>(keys.end() - end);
    keys.erase(end, keys.end());

    const std::size_t n = keys.size();
    tree.order.resize(n);
    tree.x.resize(n);
    tree.y.resize(n);
    tree.z.resize(n);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            tree.order[i] = keys[i].index;
            tree.x[i] = positions[keys[i].index].x;
            tree.y[i] = positions[keys[i].index].y;
            tree.z[i] = positions[keys[i].index].z;
        }
    });
    build_nodes(keys, tree);
    return tree;
}

}  // namespace glowworm

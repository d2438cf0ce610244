#include <algorithm>
#include <cmath>
#include <utility>

#include "viewer/light/domains.h"
#include "viewer/light/walls.h"

namespace glowworm {
namespace {

bool is_finite(const Lobe& lobe) {
    bool finite = std::isfinite(lobe.area);
    for (int a = 0; a < 3; ++a)
        finite &= std::isfinite(lobe.position[a]) && std::isfinite(lobe.ndf[a]);
    return finite;
}

/// Where a group lies on average and which way it faces; lobes that are not finite aside.
Lobe mean_lobe(std::span<const Lobe> lobes, const LightGroups& groups, std::uint32_t group) {
    Lobe mean{};
    float before = 0.0f, weights = 0.0f;
    for (std::uint32_t m = groups.starts[group]; m < groups.starts[group + 1]; ++m) {
        const Lobe& lobe = lobes[groups.members[m]];
        const float weight = groups.share[m] - std::exchange(before, groups.share[m]);
        if (!is_finite(lobe)) continue;
        if (groups.starts[group + 1] - groups.starts[group] == 1) return lobe;
        for (int a = 0; a < 3; ++a) {
            mean.position[a] += lobe.position[a] * weight;
            mean.ndf[a] += lobe.ndf[a] * weight;
        }
        weights += weight;
        mean.area += lobe.area;
        mean.light = std::max(mean.light, lobe.light);
    }
    if (!(weights > 0.0f)) return {};
    for (int a = 0; a < 3; ++a) {
        mean.position[a] /= weights;
        mean.ndf[a] /= weights;
    }
    return mean;
}

}  // namespace

Octree LightDomains::tree_of(const LightGroups& groups, std::uint32_t coarser) const {
    Octree tree;
    tree.grid = octree_.grid;
    tree.grid.depth = octree_.grid.depth - coarser;
    tree.levels.assign(octree_.levels.begin(), octree_.levels.begin() + tree.grid.depth + 1);
    const Level leaves = tree.levels.back();
    tree.nodes.assign(octree_.nodes.begin(),
                      octree_.nodes.begin() + leaves.first_node + leaves.node_count);
    for (std::size_t d = 0; d < count(); ++d) {
        std::uint32_t group = groups.first_of_domain[d];
        for (std::uint32_t node = edges_[coarser][d]; node < edges_[coarser][d + 1]; ++node) {
            const auto first = static_cast<std::uint32_t>(tree.lobes.size());
            const std::uint32_t last_lobe = first_lobe(tree.grid.depth, node + 1);
            while (groups.coarser[d] == coarser && group < groups.first_of_domain[d + 1] &&
                   groups.starts[group] < last_lobe)
                tree.lobes.push_back(mean_lobe(octree_.lobes, groups, group++));
            tree.nodes[node] = {static_cast<std::uint32_t>(tree.lobes.size() - first) << 8, first};
        }
    }
    return tree;
}

std::vector<std::uint32_t> LightDomains::walls_of(const LightGroups& groups) const {
    std::vector<std::uint32_t> walls(groups.count());
    for (std::uint32_t coarser = 0; coarser <= most_coarser_; ++coarser) {
        if (std::ranges::find(groups.coarser, coarser) == groups.coarser.end()) continue;
        const auto there = walls_beside(tree_of(groups, coarser).view());
        auto from = there.begin();
        for (std::size_t d = 0; d < count(); ++d) {
            if (groups.coarser[d] != coarser) continue;
            const std::uint32_t first = groups.first_of_domain[d];
            const auto size = static_cast<std::ptrdiff_t>(groups.first_of_domain[d + 1] - first);
            std::copy_n(from, size, walls.begin() + first);
            from += size;
        }
    }
    return walls;
}

}  // namespace glowworm

#include "octree/filter.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "octree/error.h"
#include "octree/vec3.h"

namespace glowworm {
namespace {

constexpr std::size_t kCodesBetweenWords = 1 << 22;  // of progress

struct Totals {
    double area = 0.0;
    Vec3d ndf, albedo;

    void add(double piece, const float (&piece_ndf)[3], const float (&piece_albedo)[3]) {
        area += piece;
        ndf += Vec3d{piece_ndf[0], piece_ndf[1], piece_ndf[2]} * piece;
        albedo += Vec3d{piece_albedo[0], piece_albedo[1], piece_albedo[2]} * piece;
    }

    NodeAttributes means(double opacity) const {
        NodeAttributes out{};
        out.opacity = static_cast<float>(std::min(1.0, opacity));
        out.area = static_cast<float>(area);
        for (int axis = 0; axis < 3; ++axis) {
            out.ndf[axis] = static_cast<float>(ndf[axis] / area);
            out.albedo[axis] = static_cast<float>(albedo[axis] / area);
        }
        return out;
    }
};

constexpr std::size_t kGrain = 4096;

template <typename Body>
void for_each_index(std::size_t count, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            body(i);
    });
}

}  // namespace

NodeAttributes leaf_attributes(std::span<const Lobe> lobes, float voxel) {
    Totals totals;
    double covered = 0.0;
    for (const Lobe& lobe : lobes) {
        totals.add(lobe.area, lobe.ndf, lobe.albedo);
        const Vec3d n = normalized(Vec3d{lobe.ndf[0], lobe.ndf[1], lobe.ndf[2]});
        covered += lobe.area * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
    }
    return totals.means(covered / (static_cast<double>(voxel) * voxel));
}

NodeAttributes filter_node(const std::array<const NodeAttributes*, 8>& children) {
    Totals totals;
    std::array<double, 8> opacity{};
    for (std::size_t octant = 0; octant < 8; ++octant) {
        if (children[octant] == nullptr) continue;
        totals.add(children[octant]->area, children[octant]->ndf, children[octant]->albedo);
        opacity[octant] = children[octant]->opacity;
    }
    double most = 0.0;
    for (const std::size_t step : {std::size_t{1}, std::size_t{2}, std::size_t{4}}) {
        double columns = 0.0;
        for (std::size_t octant = 0; octant < 8; ++octant) {
            if ((octant & step) == 0) {
                columns += std::min(1.0, opacity[octant] + opacity[octant | step]);
            }
        }
        most = std::max(most, columns / 4.0);
    }
    return totals.means(most);
}

NodeTree build_nodes(const Grid& grid, std::span<const std::uint64_t> leaf_codes,
                     std::span<const std::uint8_t> lobe_counts, std::span<const Lobe> lobes,
                     const Progress& progress) {
    NodeTree tree;
    if (leaf_codes.empty()) return tree;
    const std::uint32_t depth = grid.depth;
    const auto say_done = [&](std::uint32_t levels) {
        if (progress) progress(levels, 2 * (std::uint64_t{depth} + 1));
    };

    // Codes of every level, from the leaves up; a level's masks collect while its codes do.
    std::vector<std::vector<std::uint64_t>> codes(depth + 1);
    std::vector<std::vector<std::uint8_t>> masks(depth + 1);
    codes[depth].assign(leaf_codes.begin(), leaf_codes.end());
    for (std::uint32_t level = depth; level-- > 0;) {
        codes[level].reserve(codes[level + 1].size() / 3 + 1);
        std::size_t seen = 0;
        for (const std::uint64_t code : codes[level + 1]) {
            if (seen++ % kCodesBetweenWords == 0) say_done(depth - level - 1);
            if (codes[level].empty() || codes[level].back() != code >> 3) {
                codes[level].push_back(code >> 3);
                masks[level].push_back(0);
            }
            masks[level].back() = static_cast<std::uint8_t>(masks[level].back() | 1u << (code & 7));
        }
    }

    std::uint64_t total = 0;
    for (const auto& level : codes) {
        tree.levels.push_back(
            {static_cast<std::uint32_t>(total), static_cast<std::uint32_t>(level.size())});
        total += level.size();
    }
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    if (total > kMost || lobes.size() > kMost) {
        throw Error(ExitCode::kBudget,
                    "an octree of more than 4294967295 nodes or lobes; build it less deep");
    }
    // In steps, as the system clears new memory slowly.
    const auto grow = [&](auto& values) {
        values.reserve(total);
        while (values.size() < total) {
            say_done(depth);
            values.resize(std::min<std::size_t>(values.size() + kCodesBetweenWords, total));
        }
    };
    grow(tree.nodes);
    grow(tree.attributes);

    std::uint32_t next_lobe = 0;
    const std::uint32_t first_leaf = tree.levels[depth].first_node;
    for (std::size_t i = 0; i < leaf_codes.size(); ++i) {
        if (i % kCodesBetweenWords == 0) say_done(depth);
        tree.nodes[first_leaf + i] = {std::uint32_t{lobe_counts[i]} << 8, next_lobe};
        next_lobe += lobe_counts[i];
    }
    for (std::uint32_t level = 0; level < depth; ++level) {
        std::uint32_t next_child = tree.levels[level + 1].first_node;
        for (std::size_t i = 0; i < masks[level].size(); ++i) {
            tree.nodes[tree.levels[level].first_node + i] = {masks[level][i], next_child};
            next_child += static_cast<std::uint32_t>(std::popcount(masks[level][i]));
        }
    }

    say_done(depth + 1);
    const float voxel = grid.voxel_size();
    for_each_index(leaf_codes.size(), [&](std::size_t i) {
        const Node leaf = tree.nodes[first_leaf + i];
        tree.attributes[first_leaf + i] =
            leaf_attributes(lobes.subspan(leaf.first, leaf.mask >> 8), voxel);
    });
    for (std::uint32_t level = depth; level-- > 0;) {
        say_done(2 * depth - level);
        const std::uint32_t first = tree.levels[level].first_node;
        for_each_index(tree.levels[level].node_count, [&](std::size_t i) {
            const Node node = tree.nodes[first + i];
            std::array<const NodeAttributes*, 8> children{};
            const NodeAttributes* next = &tree.attributes[node.first];
            for (std::size_t octant = 0; octant < 8; ++octant) {
                if (node.mask >> octant & 1u) children[octant] = next++;
            }
            tree.attributes[first + i] = filter_node(children);
        });
    }
    return tree;
}

}  // namespace glowworm

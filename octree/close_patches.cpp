#include "octree/close_patches.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <span>
#include <vector>

#include "octree/morton.h"

namespace glowworm {

namespace {

constexpr float kSameSide = 0.5f;   // cosine of 60 degrees, as where lobes are told apart
constexpr float kOffPlane = 0.75f;  // leaf edges: a surface that goes on stays this near its plane

/// The cell of every leaf, in the order of the leaves.
std::vector<CellIndex> leaf_cells(const OctreeView& octree) {
    std::vector<CellIndex> parents{{0, 0, 0}}, cells;
    for (std::uint32_t level = 0; level < octree.grid.depth; ++level) {
        cells.clear();
        const Level& here = octree.levels[level];
        for (std::uint32_t i = 0; i < here.node_count; ++i) {
            const std::uint32_t mask = octree.nodes[here.first_node + i].mask;
            for (std::uint32_t octant = 0; octant < 8; ++octant) {
                if ((mask >> octant & 1u) == 0) continue;
                cells.push_back({2 * parents[i].x + (octant & 1u),
                                 2 * parents[i].y + (octant >> 1 & 1u),
                                 2 * parents[i].z + (octant >> 2)});
            }
        }
        parents.swap(cells);
    }
    return parents;
}

/// The leaf at a cell, nothing where it is empty or outside.
const Node* leaf_at(const OctreeView& octree, const CellIndex& cell) {
    const std::uint32_t depth = octree.grid.depth;
    if (((cell.x | cell.y | cell.z) >> depth) != 0) return nullptr;
    const Node* node = &octree.nodes[0];
    for (std::uint32_t shift = depth; shift-- > 0;) {
        const std::uint32_t octant =
            (cell.x >> shift & 1u) | (cell.y >> shift & 1u) << 1 | (cell.z >> shift & 1u) << 2;
        if ((node->mask >> octant & 1u) == 0) return nullptr;
        const auto before = std::popcount(node->mask & ((1u << octant) - 1u));
        node = &octree.nodes[node->first + static_cast<std::uint32_t>(before)];
    }
    return node;
}

/// The lobes of a leaf: its node's, one to three.
std::span<const Lobe> lobes_of(const OctreeView& octree, const Node& leaf) {
    return octree.lobes.subspan(leaf.first, leaf.mask >> 8 & 3u);
}

Vec3f vector_of(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// Whether `beyond` is the same surface as `lobe`, one leaf on.
bool goes_on(const Lobe& lobe, const Lobe& beyond, float edge) {
    const Vec3f n = normalized(vector_of(lobe.ndf));
    const Vec3f m = normalized(vector_of(beyond.ndf));
    const Vec3f step = vector_of(beyond.position) - vector_of(lobe.position);
    return dot(n, m) > kSameSide && std::abs(dot(n, step)) < kOffPlane * edge &&
           std::abs(dot(m, step)) < kOffPlane * edge;
}

/// Closes one leaf's patches toward those of its 18 neighbours by a face or an edge where the
/// surface goes on.
void close_leaf(const OctreeView& octree, const CellIndex& cell, const Node& leaf,
                std::vector<Lobe>& closed) {
    const float edge = octree.grid.voxel_size();
    const std::span<const Lobe> lobes = lobes_of(octree, leaf);
    for (int step = 0; step < 27; ++step) {
        const int toward[3] = {step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1};
        const int axes = std::abs(toward[0]) + std::abs(toward[1]) + std::abs(toward[2]);
        if (axes == 0 || axes == 3) continue;
        // Below zero wraps round to a cell that is outside as well.
        const Node* beyond = leaf_at(octree, {cell.x + static_cast<std::uint32_t>(toward[0]),
                                              cell.y + static_cast<std::uint32_t>(toward[1]),
                                              cell.z + static_cast<std::uint32_t>(toward[2])});
        if (beyond == nullptr) continue;
        for (std::size_t i = 0; i < lobes.size(); ++i) {
            const bool continued = std::ranges::any_of(
                lobes_of(octree, *beyond),
                [&](const Lobe& other) { return goes_on(lobes[i], other, edge); });
            if (!continued) continue;
            Lobe& lobe = closed[leaf.first + i];
            for (int axis = 0; axis < 3; ++axis) {
                if (toward[axis] > 0) lobe.patch_max |= 255u << (8 * axis);
                if (toward[axis] < 0) lobe.patch_min &= ~(255u << (8 * axis));
            }
        }
    }
}

}  // namespace

bool is_finite(const Lobe& lobe) {
    const auto all = [](const float(&v)[3]) {
        return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
    };
    return all(lobe.position) && all(lobe.ndf) && all(lobe.albedo) && std::isfinite(lobe.area) &&
           std::isfinite(lobe.plane_sigma) && std::isfinite(lobe.spacing);
}

std::vector<Lobe> close_patches(const OctreeView& octree) {
    std::vector<Lobe> lobes(octree.lobes.begin(), octree.lobes.end());
    if (lobes.empty()) return lobes;
    for (Lobe& lobe : lobes) {
        if (!is_finite(lobe)) lobe = {};
    }
    const std::vector<CellIndex> cells = leaf_cells(octree);
    const Level& leaves = octree.levels[octree.grid.depth];
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, cells.size(), 256), [&](const auto& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                close_leaf(octree, cells[i], octree.nodes[leaves.first_node + i], lobes);
            }
        });
    return lobes;
}

}  // namespace glowworm

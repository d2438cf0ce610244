#include "octree/occupancy.h"

#include <algorithm>

namespace glowworm {

namespace {

constexpr std::uint64_t kLeastTable = 1 << 12;  // cells that cost nothing

using Brick = Occupancy::Brick;

/// The bits of a node's grandchildren, all of them before leaves' level or at it.
Brick brick_below(const OctreeView& octree, const Node& node) {
    std::uint64_t cells = 0;
    std::uint32_t child = node.first;
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
        if ((node.mask >> octant & 1u) == 0) continue;
        cells |= std::uint64_t{octree.nodes[child++].mask} << 8 * octant;
    }
    return {{static_cast<std::uint32_t>(cells), static_cast<std::uint32_t>(cells >> 32)}, 0, 1};
}

std::uint32_t cells_in(const Brick& brick) {
    constexpr std::uint32_t kLast = 63;
    return Occupancy::before(brick, kLast) + (brick.cells[1] >> 31);
}

/// An octree of less than three levels is the corner of one brick.
void add_corner(const OctreeView& octree, std::vector<Brick>& bricks) {
    const Node& root = octree.nodes[0];
    const Brick corner = octree.grid.depth == 2
                             ? brick_below(octree, root)
                             : Brick{{octree.grid.depth == 0 ? 1u : root.mask, 0}, 0, 1};
    bricks.insert(bricks.end(), 8, corner);
}

/// The bricks below the nodes of `level`, eight each.
void add_bricks(const OctreeView& octree, std::uint32_t level, std::vector<Brick>& bricks) {
    const Level here = octree.levels[level];
    const std::uint32_t shift = octree.grid.depth - level - 3;
    const std::uint32_t next = static_cast<std::uint32_t>(bricks.size()) + 8 * here.node_count;
    std::uint32_t cells = 0;  // so far: leaves, or nodes with bricks of their own
    for (std::uint32_t i = 0; i < here.node_count; ++i) {
        const Node& node = octree.nodes[here.first_node + i];
        std::uint32_t child = node.first;
        for (std::uint32_t octant = 0; octant < 8; ++octant) {
            if ((node.mask >> octant & 1u) == 0) {
                bricks.push_back({{0, 0}, 0, 2 << shift});
                continue;
            }
            Brick& brick = bricks.emplace_back(brick_below(octree, octree.nodes[child++]));
            brick.first = shift == 0 ? cells : next + 8 * cells;
            brick.size = 1 << shift;
            cells += cells_in(brick);
        }
    }
}

/// Says of each cell of the table which bricks are its own.
class Table {
  public:
    Table(const OctreeView& octree, Occupancy& occupancy, std::uint32_t first_bricks)
        : octree_(octree),
          occupancy_(occupancy),
          first_bricks_(first_bricks),
          first_node_(octree.levels[static_cast<std::size_t>(occupancy.table_level)].first_node) {
        occupancy.table.resize(std::size_t{1} << 3 * occupancy.table_level);
    }

    void fill(std::uint32_t node, std::int32_t level, const Vec3<std::int32_t>& cell) {
        if (level == occupancy_.table_level) {
            fill_box(cell, 1, first_bricks_ + 8 * (node - first_node_));
            return;
        }
        const std::int32_t edge = 1 << (occupancy_.table_level - level - 1);
        std::uint32_t child = octree_.nodes[node].first;
        for (std::int32_t octant = 0; octant < 8; ++octant) {
            const Vec3<std::int32_t> at{2 * cell.x + (octant & 1), 2 * cell.y + (octant >> 1 & 1),
                                        2 * cell.z + (octant >> 2)};
            if ((octree_.nodes[node].mask >> octant & 1u) != 0) {
                fill(child++, level + 1, at);
            } else {
                // The bricks of empty space come first, by the size of the cell that is empty.
                const auto size = static_cast<std::int32_t>(octree_.grid.depth) - level - 1;
                fill_box(at * edge, edge, static_cast<std::uint32_t>(8 * size));
            }
        }
    }

  private:
    void fill_box(const Vec3<std::int32_t>& low, std::int32_t edge, std::uint32_t bricks) {
        const std::int32_t level = occupancy_.table_level;
        for (std::int32_t z = low.z; z < low.z + edge; ++z) {
            for (std::int32_t y = low.y; y < low.y + edge; ++y) {
                const std::ptrdiff_t row = ((std::ptrdiff_t{z} << level | y) << level) + low.x;
                std::fill_n(occupancy_.table.begin() + row, edge, bricks);
            }
        }
    }

    const OctreeView& octree_;
    Occupancy& occupancy_;
    std::uint32_t first_bricks_, first_node_;
};

}  // namespace

Occupancy make_occupancy(const OctreeView& octree) {
    Occupancy occupancy;
    const auto depth = static_cast<std::int32_t>(octree.grid.depth);
    const std::uint64_t leaves = octree.levels[octree.grid.depth].node_count;
    while (occupancy.table_shift < depth &&
           std::uint64_t{1} << 3 * (depth - occupancy.table_shift) > std::max(kLeastTable, leaves))
        occupancy.table_shift += 3;
    occupancy.table_level = std::max(depth - occupancy.table_shift, 0);

    for (std::int32_t shift = 0; shift <= depth; ++shift)
        occupancy.bricks.insert(occupancy.bricks.end(), 8, Brick{{0, 0}, 0, 1 << shift >> 1});
    const auto first_bricks = static_cast<std::uint32_t>(occupancy.bricks.size());
    if (depth < 3) {
        add_corner(octree, occupancy.bricks);
    } else {
        for (auto level = static_cast<std::uint32_t>(occupancy.table_level);
             level < octree.grid.depth; level += 3)
            add_bricks(octree, level, occupancy.bricks);
    }
    Table(octree, occupancy, first_bricks).fill(0, 0, {0, 0, 0});
    return occupancy;
}

}  // namespace glowworm

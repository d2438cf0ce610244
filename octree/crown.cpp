#include "octree/crown.h"

#include <array>
#include <string>
#include <utility>

#include "octree/error.h"
#include "octree/filter.h"
#include "octree/merge_chunks.h"

namespace glowworm {
namespace {

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ExitCode::kUsage, why);
}

/// A node of one tile.
struct TileNode {
    std::uint32_t tile;
    std::uint32_t node;
};

/// Walks down from the root as long as several tiles share a cell.
class CrownBuilder {
  public:
    explicit CrownBuilder(std::span<const OctreeView> tiles) : tiles_(tiles) {
        crown_.levels.resize(tiles.front().grid.depth + 1);
    }

    Crown build() {
        std::vector<TileNode> roots;
        for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile)
            roots.push_back({tile, 0});
        if (roots.size() > 1) join_cell(roots, 0);
        const auto last = static_cast<std::uint32_t>(tiles_.size());
        if (fit(0, last)) {
            add_chunks(0, last);
        } else {
            split_cell(roots, 0);
        }
        return std::move(crown_);
    }

  private:
    using Children = std::array<std::vector<TileNode>, 8>;

    Children children_of(std::span<const TileNode> cell) const {
        Children children;
        for (const TileNode& at : cell) {
            const Node node = tiles_[at.tile].nodes[at.node];
            std::uint32_t child = node.first;
            for (std::size_t octant = 0; octant < 8; ++octant) {
                if (node.mask >> octant & 1u) children[octant].push_back({at.tile, child++});
            }
        }
        return children;
    }

    NodeAttributes join_cell(std::span<const TileNode> cell, std::uint32_t level) {
        if (cell.size() == 1) return tiles_[cell[0].tile].attributes[cell[0].node];
        if (level == tiles_[0].grid.depth)
            refuse("two of the tiles share a leaf; join tiles of one grid");
        const std::size_t place = crown_.levels[level].size();
        crown_.levels[level].emplace_back();

        std::uint32_t mask = 0;
        std::array<NodeAttributes, 8> values;
        std::array<const NodeAttributes*, 8> children{};
        const Children below = children_of(cell);
        for (std::size_t octant = 0; octant < 8; ++octant) {
            if (below[octant].empty()) continue;
            mask |= 1u << octant;
            values[octant] = join_cell(below[octant], level + 1);
            children[octant] = &values[octant];
        }
        crown_.levels[level][place] = {mask, filter_node(children)};
        return crown_.levels[level][place].attributes;
    }

    bool fit(std::uint32_t first, std::uint32_t end) const {
        return fit_one_chunk(tiles_.subspan(first, end - first));
    }

    void add_chunks(std::uint32_t first, std::uint32_t end) {
        // Empty tiles beside the only one with points change nothing.
        while (first < end && tiles_[first].sample_count == 0)
            ++first;
        while (first < end && tiles_[end - 1].sample_count == 0)
            --end;
        if (first < end) crown_.chunks.push_back({first, end, end - first > 1});
    }

    /// As split_into_chunks cuts one octree's cells.
    void split_cell(std::span<const TileNode> cell, std::uint32_t level) {
        if (cell.size() == 1) {
            crown_.chunks.push_back({cell[0].tile, cell[0].tile + 1, false});
            return;
        }
        std::uint32_t first = cell.front().tile, next = first;
        for (const auto& child : children_of(cell)) {
            if (child.empty()) continue;
            if (child.front().tile != next) refuse("the tiles are not cells of one grid");
            const std::uint32_t end = child.back().tile + 1;
            if (!fit(next, end)) {
                add_chunks(first, next);
                split_cell(child, level + 1);
                first = end;
            } else if (!fit(first, end)) {
                add_chunks(first, next);
                first = next;
            }
            next = end;
        }
        add_chunks(first, next);
    }

    std::span<const OctreeView> tiles_;
    Crown crown_;
};

}  // namespace

Crown build_crown(std::span<const OctreeView> tiles) {
    return CrownBuilder(tiles).build();
}

}  // namespace glowworm

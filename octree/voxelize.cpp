#include "octree/voxelize.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

#include "octree/splat.h"

namespace glowworm {
namespace {

constexpr std::size_t kBlock = 16384;  ///< surfels a task sweeps, as many more as share a leaf
constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

/// What one task cuts and sweeps.
struct Block {
    std::size_t begin, end;               ///< surfels
    std::uint64_t first_code, past_code;  ///< leaves: all of a tile's between its blocks, none in
                                          ///< blocks of surfels outside the tile
    bool has_leaves() const { return first_code < past_code; }
};

/// Parts of discs in other leaves than their surfel's own: such a leaf's code, the surfel and the
/// pieces. Few leave their block: the others need to be sorted only inside it.
struct Strays {
    CodeIndices near, far;
};

/// Blocks of all surfels, in their order. Those of the tile's own, `inside`, end where a leaf does.
std::vector<Block> cut_into_blocks(std::span<const CodeIndex> order,
                                   std::span<const CodeIndex> inside, const Grid& grid) {
    const auto first = static_cast<std::size_t>(inside.data() - order.data());
    const std::size_t past = first + inside.size();
    const auto code_of = [&](std::size_t i) { return code_at_level(order[i].code, grid.depth); };
    std::vector<Block> blocks;
    const auto cut_outside = [&](std::size_t begin, std::size_t end) {
        for (; begin < end; begin += kBlock)
            blocks.push_back({begin, std::min(end, begin + kBlock), 0, 0});
    };
    cut_outside(0, first);
    std::size_t begin = first;
    do {
        std::size_t end = std::min(past, begin + kBlock);
        while (end < past && code_of(end) == code_of(end - 1))
            ++end;
        blocks.push_back(
            {begin, end, begin == first ? 0 : code_of(begin), end == past ? kNone : code_of(end)});
        begin = end;
    } while (begin < past);
    cut_outside(past, order.size());
    return blocks;
}

/// Cuts the discs of a block at the leaves of `tile`. `own`: [all surfels] the pieces in each one's
/// own leaf.
Strays cut_discs(std::span<const Surfel> surfels, const Block& block, const Grid& grid,
                 const OctreeCell& tile, std::span<PieceSet> own) {
    const std::uint32_t tile_shift = 3 * (grid.depth - tile.level);
    const LeafGrid leaves(grid);
    Strays strays;
    DiscParts parts;
    for (std::size_t i = block.begin; i < block.end; ++i) {
        const std::size_t count = Disc(surfels[i], leaves).cut(parts);
        own[i] = parts[0].pieces;
        for (std::size_t p = 1; p < count; ++p) {
            const std::uint64_t code = morton_encode(parts[p].leaf);
            if (code >> tile_shift != tile.code) continue;
            const bool near = code >= block.first_code && code < block.past_code;
            (near ? strays.near : strays.far)
                .push_back({code, static_cast<std::uint32_t>(i), parts[p].pieces});
        }
    }
    radix_sort(strays.near);
    return strays;
}

/// Those that left their blocks, sorted.
CodeIndices gather_far(std::span<Strays> blocks) {
    std::size_t total = 0;
    for (const Strays& block : blocks)
        total += block.far.size();
    CodeIndices far;
    far.reserve(total);
    for (Strays& block : blocks) {
        far.insert(far.end(), block.far.begin(), block.far.end());
        CodeIndices().swap(block.far);
    }
    radix_sort(far);
    return far;
}

/// Of entries in ascending order, those with codes from `first` on and before `past`.
std::span<const CodeIndex> run_of(std::span<const CodeIndex> entries, std::uint64_t first,
                                  std::uint64_t past) {
    const auto before = [](const CodeIndex& entry, std::uint64_t code) {
        return entry.code < code;
    };
    const auto begin = std::lower_bound(entries.begin(), entries.end(), first, before);
    return {begin, std::lower_bound(begin, entries.end(), past, before)};
}

/// A run of sorted strays that is taken from the front.
class StrayQueue {
  public:
    explicit StrayQueue(std::span<const CodeIndex> strays) : strays_(strays) {}
    std::uint64_t code() const { return strays_.empty() ? kNone : strays_.front().code; }
    bool comes_before(const StrayQueue& other) const {
        return code() < other.code() ||
               (code() == other.code() && strays_.front().index < other.strays_.front().index);
    }
    CodeIndex take() {
        const CodeIndex first = strays_.front();
        strays_ = strays_.subspan(1);
        return first;
    }

  private:
    std::span<const CodeIndex> strays_;
};

/// Sums up the leaves of a block: each leaf's own surfels, then the strays in the order of theirs,
/// so that the sums do not depend on where blocks end.
Leaves sweep(std::span<const Surfel> surfels, std::span<const CodeIndex> order, const Block& block,
             const Grid& grid, std::span<const PieceSet> own, StrayQueue near, StrayQueue far) {
    Leaves out;
    LeafSums sums;
    std::array<Lobe, kMaxLobes> lobes;
    const LeafGrid leaves(grid);
    const std::uint32_t depth = grid.depth;
    const double voxel = grid.voxel_size();
    const auto own_code = [&](std::size_t i) {
        return i < block.end ? code_at_level(order[i].code, depth) : kNone;
    };
    for (std::size_t i = block.begin;;) {
        const std::uint64_t code = std::min({own_code(i), near.code(), far.code()});
        if (code == kNone) return out;
        const CellIndex leaf = morton_decode(code);
        sums.begin(grid.cell_min(leaf, depth), voxel);
        const auto add = [&](std::size_t surfel, PieceSet pieces) {
            Disc(surfels[surfel], leaves).add_to(sums, surfels[surfel], {leaf, pieces});
        };
        for (; own_code(i) == code; ++i)
            add(i, own[i]);
        while (near.code() == code || far.code() == code) {
            const CodeIndex stray = (near.comes_before(far) ? near : far).take();
            add(stray.index, stray.part);
        }
        const std::size_t count = sums.finish(lobes);
        out.codes.push_back(code);
        out.lobe_counts.push_back(static_cast<std::uint8_t>(count));
        out.lobes.insert(out.lobes.end(), lobes.begin(), lobes.begin() + static_cast<int>(count));
    }
}

Leaves joined(std::vector<Leaves>& parts) {
    std::vector<std::size_t> first_leaf{0}, first_lobe{0};
    for (const Leaves& part : parts) {
        first_leaf.push_back(first_leaf.back() + part.codes.size());
        first_lobe.push_back(first_lobe.back() + part.lobes.size());
    }
    Leaves leaves;
    leaves.codes.resize(first_leaf.back());
    leaves.lobe_counts.resize(first_leaf.back());
    leaves.lobes.resize(first_lobe.back());
    const auto at = [](auto& records, std::size_t first) {
        return records.begin() + static_cast<std::ptrdiff_t>(first);
    };
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
        std::ranges::copy(parts[p].codes, at(leaves.codes, first_leaf[p]));
        std::ranges::copy(parts[p].lobe_counts, at(leaves.lobe_counts, first_leaf[p]));
        std::ranges::copy(parts[p].lobes, at(leaves.lobes, first_lobe[p]));
        parts[p] = {};
    });
    return leaves;
}

}  // namespace

std::span<const CodeIndex> entries_in(std::span<const CodeIndex> order, const OctreeCell& tile) {
    return run_of(order, tile.first_code(), tile.end_code());
}

Leaves voxelize(std::span<const Surfel> surfels, std::span<const CodeIndex> order, const Grid& grid,
                const OctreeCell& tile, SharedProgress& progress) {
    // 1. Where discs reach into other leaves than their own.
    const std::vector<Block> blocks = cut_into_blocks(order, entries_in(order, tile), grid);
    Unfilled<PieceSet> own(order.size());
    std::vector<Strays> strays(blocks.size());
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        strays[b] = cut_discs(surfels, blocks[b], grid, tile, own);
        progress.add(blocks[b].end - blocks[b].begin);
    });
    const CodeIndices far = gather_far(strays);

    // 2. Leaf by leaf, what lies in it.
    std::vector<Leaves> parts(blocks.size());
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
        const Block& block = blocks[b];
        if (!block.has_leaves()) return;
        parts[b] = sweep(surfels, order, block, grid, own, StrayQueue(strays[b].near),
                         StrayQueue(run_of(far, block.first_code, block.past_code)));
        strays[b] = {};
        progress.add(block.end - block.begin);
    });
    return joined(parts);
}

}  // namespace glowworm

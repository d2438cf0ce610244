#include "octree/voxelize.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

#include "octree/splat.h"

namespace glowworm {
namespace {

constexpr std::size_t kBlock = 16384;  ///< surfels a task sweeps

/// Discs that reach into other leaves of `tile` than their surfel's own: such a leaf's code, the
/// surfel, and the first of its pieces there.
std::vector<CodeIndex> collect_strays(std::span<const Surfel> surfels,
                                      std::span<const CodeIndex> order, const Grid& grid,
                                      const OctreeCell& tile) {
    const std::uint32_t tile_shift = 3 * (grid.depth - tile.level);
    const std::size_t blocks = (order.size() + kBlock - 1) / kBlock;
    std::vector<std::vector<CodeIndex>> found(blocks);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
        const std::size_t end = std::min(order.size(), (block + 1) * kBlock);
        DiscPieces disc(grid);
        for (std::size_t i = block * kBlock; i < end; ++i) {
            if (i + kPrefetchAhead < end) prefetch(&surfels[order[i + kPrefetchAhead].index]);
            const Surfel& surfel = surfels[order[i].index];
            const Splat splat = splat_of(surfel, grid.voxel_size());
            if (splat.pieces == 1 || stays_inside(surfel, splat, grid)) continue;
            disc.place(surfel);
            disc.for_each_other_leaf([&](std::uint32_t piece) {
                const std::uint64_t leaf = morton_encode(disc.cell(piece));
                if (leaf >> tile_shift == tile.code)
                    found[block].push_back({leaf, order[i].index, piece});
            });
        }
    });

    std::size_t total = 0;
    for (const auto& part : found)
        total += part.size();
    std::vector<CodeIndex> strays;
    strays.reserve(total);
    for (auto& part : found) {
        strays.insert(strays.end(), part.begin(), part.end());
        std::vector<CodeIndex>().swap(part);
    }
    radix_sort(strays);
    return strays;
}

/// Sweeps one run of whole leaves: surfels and strays side by side, both in Morton order.
Leaves sweep(std::span<const Surfel> surfels, std::span<const CodeIndex> order,
             std::span<const CodeIndex> strays, const Grid& grid) {
    constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
    Leaves out;
    LeafSums leaf;
    DiscPieces disc(grid);
    std::array<Lobe, kMaxLobes> lobes;
    const std::uint32_t depth = grid.depth;
    const double voxel = grid.voxel_size();

    std::size_t i = 0, s = 0;
    while (i < order.size() || s < strays.size()) {
        const std::uint64_t own = i < order.size() ? code_at_level(order[i].code, depth) : kNone;
        const std::uint64_t code = std::min(own, s < strays.size() ? strays[s].code : kNone);
        leaf.begin(grid.cell_min(morton_decode(code), depth), voxel);
        for (; i < order.size() && code_at_level(order[i].code, depth) == code; ++i) {
            if (i + kPrefetchAhead < order.size())
                prefetch(&surfels[order[i + kPrefetchAhead].index]);
            const Surfel& surfel = surfels[order[i].index];
            disc.place(surfel);
            disc.add_to(leaf, surfel, 0);
        }
        for (; s < strays.size() && strays[s].code == code; ++s) {
            if (s + kPrefetchAhead < strays.size())
                prefetch(&surfels[strays[s + kPrefetchAhead].index]);
            const Surfel& surfel = surfels[strays[s].index];
            disc.place(surfel);
            disc.add_to(leaf, surfel, strays[s].part);
        }
        const std::size_t count = leaf.finish(lobes);
        out.codes.push_back(code);
        out.lobe_counts.push_back(static_cast<std::uint8_t>(count));
        out.lobes.insert(out.lobes.end(), lobes.begin(), lobes.begin() + static_cast<int>(count));
    }
    return out;
}

template <typename T>
void append(std::vector<T>& to, std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
    std::vector<T>().swap(from);
}

}  // namespace

std::span<const CodeIndex> entries_in(std::span<const CodeIndex> order, const OctreeCell& tile) {
    const auto before = [](const CodeIndex& entry, std::uint64_t code) {
        return entry.code < code;
    };
    const auto begin = std::lower_bound(order.begin(), order.end(), tile.first_code(), before);
    return {begin, std::lower_bound(begin, order.end(), tile.end_code(), before)};
}

Leaves voxelize(std::span<const Surfel> surfels, std::span<const CodeIndex> all, const Grid& grid,
                double largest_radius, const OctreeCell& tile) {
    Surfel largest;
    largest.radius = static_cast<float>(largest_radius);
    std::vector<CodeIndex> strays;
    if (splat_of(largest, grid.voxel_size()).pieces > 1) {
        strays = collect_strays(surfels, all, grid, tile);
    }
    const std::span<const CodeIndex> order = entries_in(all, tile);

    // Cuts between leaves, then between the strays at the same codes.
    std::vector<std::size_t> cuts{0};
    while (cuts.back() < order.size()) {
        std::size_t cut = std::min(order.size(), cuts.back() + kBlock);
        while (cut < order.size() && code_at_level(order[cut].code, grid.depth) ==
                                         code_at_level(order[cut - 1].code, grid.depth)) {
            ++cut;
        }
        cuts.push_back(cut);
    }
    if (order.empty()) cuts.push_back(0);  // a tile may have nothing but strays
    std::vector<std::size_t> stray_cuts(cuts.size(), strays.size());
    stray_cuts[0] = 0;
    for (std::size_t c = 1; c + 1 < cuts.size(); ++c) {
        const std::uint64_t code = code_at_level(order[cuts[c]].code, grid.depth);
        stray_cuts[c] = static_cast<std::size_t>(
            std::lower_bound(strays.begin(), strays.end(), code,
                             [](const CodeIndex& e, std::uint64_t v) { return e.code < v; }) -
            strays.begin());
    }

    std::vector<Leaves> parts(cuts.size() - 1);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t b) {
        parts[b] = sweep(
            surfels, order.subspan(cuts[b], cuts[b + 1] - cuts[b]),
            std::span(strays).subspan(stray_cuts[b], stray_cuts[b + 1] - stray_cuts[b]), grid);
    });

    Leaves leaves;
    std::size_t leaf_total = 0, lobe_total = 0;
    for (const Leaves& part : parts) {
        leaf_total += part.codes.size();
        lobe_total += part.lobes.size();
    }
    leaves.codes.reserve(leaf_total);
    leaves.lobe_counts.reserve(leaf_total);
    leaves.lobes.reserve(lobe_total);
    for (Leaves& part : parts) {
        append(leaves.codes, part.codes);
        append(leaves.lobe_counts, part.lobe_counts);
        append(leaves.lobes, part.lobes);
    }
    return leaves;
}

}  // namespace glowworm

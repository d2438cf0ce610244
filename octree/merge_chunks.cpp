#include "octree/merge_chunks.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "octree/chunk.h"

namespace glowworm {
namespace {

/// The cell that a chunk counts from.
OctreeCell box_of(const Grid& grid, const Chunk& chunk) {
    const auto level = static_cast<std::uint32_t>(std::ilogb(grid.cube_edge / chunk.box_edge));
    const auto axis = [&](int i) {
        return static_cast<std::uint32_t>(std::lround(
            (static_cast<double>(chunk.box_min[i]) - grid.cube_min[i]) / chunk.box_edge));
    };
    return {level, morton_encode({axis(0), axis(1), axis(2)})};
}

/// The smallest cell that holds two, `a` and `b` included.
OctreeCell common_cell(const OctreeCell& a, const OctreeCell& b) {
    const std::uint64_t differing = a.first_code() ^ b.first_code();
    OctreeCell cell;
    cell.level =
        std::min({a.level, b.level,
                  kMortonLevels - static_cast<std::uint32_t>((std::bit_width(differing) + 2) / 3)});
    cell.code = code_at_level(a.first_code(), cell.level);
    return cell;
}

/// Counts a position from a larger cell: exact, because positions are truncated.
PackedSurfel recount(PackedSurfel surfel, const OctreeCell& from, const OctreeCell& to) {
    const CellIndex inner = morton_decode(from.code), outer = morton_decode(to.code);
    const std::uint32_t up = from.level - to.level;
    const auto axis = [&](std::uint32_t cell, std::uint32_t outer_cell, std::uint32_t q) {
        const std::uint64_t steps = (std::uint64_t{cell} << 16 | q) >> up;
        return static_cast<std::uint32_t>(steps - (std::uint64_t{outer_cell} << 16)) & 0xffff;
    };
    const std::uint32_t x = axis(inner.x, outer.x, surfel.position_xy & 0xffff);
    const std::uint32_t y = axis(inner.y, outer.y, surfel.position_xy >> 16);
    const std::uint32_t z = axis(inner.z, outer.z, surfel.position_z_radius & 0xffff);
    surfel.position_xy = x | y << 16;
    surfel.position_z_radius = z | (surfel.position_z_radius & 0xffff0000u);
    return surfel;
}

/// Morton code at level 21; what lies below the position's own levels is 0.
std::uint64_t full_code_of(const PackedSurfel& surfel, const OctreeCell& box) {
    constexpr std::uint32_t kPositionLevels = 16;
    const std::uint64_t inside = morton_encode(
        {surfel.position_xy & 0xffff, surfel.position_xy >> 16, surfel.position_z_radius & 0xffff});
    const std::uint32_t levels = kMortonLevels - box.level;  // to be filled from the position
    return box.code << 3 * levels |
           (levels < kPositionLevels ? inside >> 3 * (kPositionLevels - levels)
                                     : inside << 3 * (levels - kPositionLevels));
}

}  // namespace

bool fit_one_chunk(std::span<const OctreeView> tiles) {
    std::uint64_t samples = 0;
    std::vector<const OctreeView*> with_points;
    for (const OctreeView& tile : tiles) {
        samples += tile.sample_count;
        if (tile.sample_count > 0) with_points.push_back(&tile);
    }
    if (samples > kMaxChunkSurfels) return false;
    const auto has_one = [](const OctreeView* tile) { return tile->chunks.size() == 1; };
    if (!std::ranges::all_of(with_points, has_one)) return false;  // some needed smaller boxes
    if (with_points.size() < 2) return true;

    const Grid& grid = tiles.front().grid;
    CodeIndices codes;
    codes.reserve(samples);
    for (const OctreeView* tile : with_points) {
        const OctreeCell box = box_of(grid, tile->chunks[0]);
        for (const PackedSurfel& surfel : tile->surfels)
            codes.push_back({full_code_of(surfel, box), 0, 0});
    }
    radix_sort(codes);
    const OctreeCell box = common_cell(box_of(grid, with_points.front()->chunks[0]),
                                       box_of(grid, with_points.back()->chunks[0]));
    return needed_box_level(codes) <= box.level;
}

MergedChunk merge_chunks(std::span<const OctreeView> tiles) {
    const Grid& grid = tiles.front().grid;
    const OctreeCell box = common_cell(box_of(grid, tiles.front().chunks.front()),
                                       box_of(grid, tiles.back().chunks.back()));
    MergedChunk merged;
    for (const OctreeView& tile : tiles) {
        for (const Chunk& chunk : tile.chunks) {
            const OctreeCell from = box_of(grid, chunk);
            for (const PackedSurfel& surfel : tile.surfels.subspan(chunk.first, chunk.count))
                merged.surfels.push_back(recount(surfel, from, box));
        }
    }
    merged.chunk = arrange_chunk(merged.surfels, grid, morton_decode(box.code), box.level);
    return merged;
}

}  // namespace glowworm

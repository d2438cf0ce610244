#include "viewer/frame/chunk_boxes.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "octree/morton.h"

namespace glowworm {
namespace {

constexpr std::uint32_t kLevels = 16;   // of a quantised position
constexpr std::size_t kLookedAt = 256;  // surfels, the chunk's first

CellIndex cell_of(const PackedSurfel& surfel, std::uint32_t level) {
    const std::uint32_t shift = kLevels - level;
    return {(surfel.position_xy & 0xffff) >> shift, (surfel.position_xy >> 16) >> shift,
            (surfel.position_z_radius & 0xffff) >> shift};
}

std::size_t distinct_cells(std::span<const PackedSurfel> surfels, std::uint32_t level) {
    std::vector<std::uint64_t> codes;
    for (const PackedSurfel& surfel : surfels)
        codes.push_back(morton_encode(cell_of(surfel, level)));
    std::ranges::sort(codes);
    return codes.size() - std::ranges::unique(codes).size();
}

/// The finest level whose cells, as the first surfels show them, hold all of the chunk.
std::uint32_t known_level(std::span<const PackedSurfel> first, std::size_t count) {
    if (first.size() == count) return kLevels;
    for (std::uint32_t level = kLevels; level > 0; --level) {
        if (distinct_cells(first, level) < first.size()) return level;
    }
    return 0;
}

}  // namespace

std::vector<ChunkBox> chunk_boxes(const OctreeView& octree) {
    std::vector<ChunkBox> boxes;
    boxes.reserve(octree.chunks.size());
    for (const Chunk& chunk : octree.chunks) {
        const auto first =
            octree.surfels.subspan(chunk.first, std::min<std::size_t>(chunk.count, kLookedAt));
        const std::uint32_t level = known_level(first, chunk.count);
        std::array<std::uint32_t, 3> low{~0u, ~0u, ~0u}, high{0, 0, 0};
        for (const PackedSurfel& surfel : first) {
            const CellIndex cell = cell_of(surfel, level);
            const std::array<std::uint32_t, 3> at{cell.x, cell.y, cell.z};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], at[axis]);
                high[axis] = std::max(high[axis], at[axis] + 1);
            }
        }
        if (first.empty()) low = high = {0, 0, 0};
        const double edge = static_cast<double>(chunk.box_edge) / static_cast<double>(1u << level);
        ChunkBox box;
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            box.centre[axis] = chunk.box_min[a] + edge * (low[a] + high[a]) / 2.0;
            box.half[axis] = edge * (high[a] - low[a]) / 2.0;
        }
        boxes.push_back(box);
    }
    return boxes;
}

}  // namespace glowworm

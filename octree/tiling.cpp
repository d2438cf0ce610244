#include "octree/tiling.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "octree/error.h"
#include "octree/size_estimate.h"
#include "octree/splat.h"

namespace glowworm {
namespace {

constexpr std::uint32_t kLevelsDown = 7;  ///< 2 million cells are weighed

std::uint64_t full_code_of(const Surfel& surfel, const Grid& grid) {
    return grid.code_of(vec3_cast<double>(surfel.position));
}

}  // namespace

std::uint64_t bytes_to_build(const Surfel& surfel, const Grid& grid) {
    const Splat splat = splat_of(surfel.radius / grid.voxel_size());
    // A disc meets about two leaves for each voxel face of its area, and each piece at most one.
    const double faces = 3.15 * splat.radius * splat.radius;
    const auto leaves = static_cast<std::uint64_t>(std::min<double>(splat.pieces - 1, 2.0 * faces));
    // Where pieces lie several leaves apart, each hangs from a chain of nodes.
    const double apart = std::sqrt(faces / splat.pieces);
    const double chain = std::max(0.0, std::ceil(std::log2(std::max(apart, 1.0))));
    return kBytesPerSurfel +
           leaves * (kBytesPerLeaf + static_cast<std::uint64_t>(chain) * kBytesPerNode);
}

CellWeights::CellWeights(const Grid& grid, const OctreeCell& root)
    : grid_(grid),
      root_(root),
      level_(std::min(grid.depth, root.level + kLevelsDown)),
      weights_(std::size_t{1} << 3 * (level_ - root.level), 0) {}

void CellWeights::add(const Surfel& surfel) {
    const std::uint64_t code = full_code_of(surfel, grid_);
    if (!root_.holds(code)) return;
    const std::uint64_t first = root_.code << 3 * (level_ - root_.level);
    weights_[code_at_level(code, level_) - first] += bytes_to_build(surfel, grid_);
}

std::uint64_t CellWeights::total() const {
    return std::accumulate(weights_.begin(), weights_.end(), std::uint64_t{0});
}

Tiling::Tiling(const CellWeights& weights, std::uint64_t capacity, std::uint64_t fixed)
    : grid_(weights.grid()),
      root_(weights.root()),
      level_(weights.level()),
      tile_of_cell_(weights.weights().size()) {
    cut(weights, root_, capacity, fixed);
}

void Tiling::cut(const CellWeights& weights, OctreeCell cell, std::uint64_t capacity,
                 std::uint64_t fixed) {
    const std::uint32_t shift = 3 * (level_ - cell.level);
    const std::uint64_t root_first = root_.code << 3 * (level_ - root_.level);
    const auto first = static_cast<std::ptrdiff_t>((cell.code << shift) - root_first);
    const auto end = first + (std::ptrdiff_t{1} << shift);
    const auto all = weights.weights();
    const std::uint64_t sum =
        std::accumulate(all.begin() + first, all.begin() + end, std::uint64_t{0});
    if (sum > capacity && cell.level < level_) {
        for (std::uint64_t octant = 0; octant < 8; ++octant)
            cut(weights, {cell.level + 1, cell.code << 3 | octant}, capacity, fixed);
        return;
    }
    if (sum > capacity) {
        throw Error(ExitCode::kBudget,
                    "the points of one cell of the octree need about " +
                        std::to_string((sum * 4 / 3 + fixed) / 1000000 + 1) +
                        " MB of memory, more than the limit; raise --memory-limit, build it less "
                        "deep or thin the points");
    }
    std::fill(tile_of_cell_.begin() + first, tile_of_cell_.begin() + end,
              static_cast<std::uint32_t>(tiles_.size()));
    tiles_.push_back(cell);
}

void Tiling::find(const Surfel& surfel, std::vector<std::uint32_t>& reached) const {
    reached.clear();
    const std::uint64_t root_first = root_.code << 3 * (level_ - root_.level);
    const std::uint32_t up = 3 * (grid_.depth - level_), to_root = 3 * (level_ - root_.level);
    DiscParts parts;
    const std::size_t count = Disc(surfel, LeafGrid(grid_)).cut(parts);
    for (const DiscPart& part : std::span(parts).first(count)) {
        const std::uint64_t cell = morton_encode(part.leaf) >> up;
        if (cell >> to_root != root_.code) continue;
        const std::uint32_t tile = tile_of_cell_[cell - root_first];
        if (std::find(reached.begin(), reached.end(), tile) == reached.end())
            reached.push_back(tile);
    }
}

bool reaches(const Surfel& surfel, const Grid& grid, const OctreeCell& cell) {
    if (cell.level == 0) return true;
    const std::uint32_t up = 3 * (grid.depth - cell.level);
    DiscParts parts;
    const std::size_t count = Disc(surfel, LeafGrid(grid)).cut(parts);
    return std::ranges::any_of(std::span(parts).first(count), [&](const DiscPart& part) {
        return morton_encode(part.leaf) >> up == cell.code;
    });
}

}  // namespace glowworm

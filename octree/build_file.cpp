#include "octree/build_file.h"

#include <algorithm>
#include <string>
#include <vector>

#include "octree/error.h"
#include "octree/join.h"
#include "octree/spill.h"
#include "octree/voxelize.h"

namespace glowworm {
namespace {

constexpr std::uint64_t kLeastLimit = std::uint64_t{64} << 20;
constexpr std::uint64_t kBytesPerSurfel = 240;  ///< measured peak of build_octree, with some room
constexpr std::uint64_t kFixedBytes = std::uint64_t{24} << 20;
constexpr std::uint32_t kCountLevel = 7;  ///< finest cells that tiles are made of

/// Cells of the grid with no more surfels than fit, for each cell of the counting level.
struct Tiling {
    std::uint32_t level = 0;  ///< of the counted cells
    std::vector<OctreeCell> tiles;
    std::vector<std::uint32_t> tile_of_cell;  ///< [8^level], by Morton code

    std::uint32_t tile_of(std::uint64_t full_code) const {
        return tile_of_cell[code_at_level(full_code, level)];
    }
};

void split_until_they_fit(std::span<const std::uint32_t> counts, OctreeCell cell,
                          std::uint64_t capacity, Tiling& tiling) {
    const std::uint32_t shift = 3 * (tiling.level - cell.level);
    const std::uint64_t first = cell.code << shift, end = (cell.code + 1) << shift;
    std::uint64_t sum = 0;
    for (std::uint64_t c = first; c < end; ++c)
        sum += counts[c];
    if (sum > capacity && cell.level < tiling.level) {
        for (std::uint64_t octant = 0; octant < 8; ++octant) {
            split_until_they_fit(counts, {cell.level + 1, cell.code << 3 | octant}, capacity,
                                 tiling);
        }
        return;
    }
    if (sum > capacity) {
        throw Error(
            ExitCode::kBudget,
            "one cell of the octree has " + std::to_string(sum) +
                " points, more than the memory limit holds at once; raise --memory-limit or "
                "thin the points");
    }
    std::fill(tiling.tile_of_cell.begin() + static_cast<std::ptrdiff_t>(first),
              tiling.tile_of_cell.begin() + static_cast<std::ptrdiff_t>(end),
              static_cast<std::uint32_t>(tiling.tiles.size()));
    tiling.tiles.push_back(cell);
}

/// Hands every usable surfel of the stream over, its values in range.
template <typename Visit>
void for_each_usable(const SurfelStream& stream, const CloudSummary& summary, const Visit& visit) {
    stream.for_each([&](std::span<const Surfel> batch) {
        for (Surfel s : batch) {
            if (!is_usable(s)) continue;
            if (summary.needs_repair) repair(s, summary.median_radius);
            visit(s);
        }
    });
}

/// The tiles that a surfel's disc reaches, its own first.
void find_tiles(const Surfel& surfel, const Grid& grid, const Tiling& tiling,
                std::vector<std::uint32_t>& tiles) {
    tiles.clear();
    const Splat splat = splat_of(surfel, grid.voxel_size());
    for (std::uint32_t piece = 0; piece < splat.pieces; ++piece) {
        const std::uint32_t tile =
            tiling.tile_of(grid.code_of(piece_position(surfel, splat, piece)));
        if (std::find(tiles.begin(), tiles.end(), tile) == tiles.end()) tiles.push_back(tile);
    }
}

Tiling plan_tiles(const SurfelStream& stream, const CloudSummary& summary, const Grid& grid,
                  std::uint64_t capacity) {
    Tiling tiling;
    tiling.level = std::min(grid.depth, kCountLevel);
    tiling.tile_of_cell.resize(std::size_t{1} << 3 * tiling.level);
    std::vector<std::uint32_t> counts(tiling.tile_of_cell.size(), 0);
    for_each_usable(stream, summary, [&](const Surfel& s) {
        ++counts[code_at_level(grid.code_of(vec3_cast<double>(s.position)), tiling.level)];
    });
    split_until_they_fit(counts, {}, capacity, tiling);
    return tiling;
}

/// What is the same for every way to build.
SurfelCloud empty_cloud(const SurfelStream& stream) {
    return {stream.origin, {}, stream.stations, stream.area_lights};
}

Octree build_at_once(const SurfelStream& stream, const BuildSettings& settings, std::uint64_t count,
                     const Progress& progress) {
    SurfelCloud cloud = empty_cloud(stream);
    cloud.surfels.reserve(count);
    stream.for_each([&](std::span<const Surfel> batch) {
        cloud.surfels.insert(cloud.surfels.end(), batch.begin(), batch.end());
    });
    return build_octree(cloud, settings, progress);
}

}  // namespace

std::uint64_t memory_to_build(std::uint64_t surfels) {
    return kFixedBytes + surfels * kBytesPerSurfel;
}

BuildFileReport build_octree_file(const SurfelStream& stream, const BuildSettings& settings,
                                  const MemorySettings& memory, const std::filesystem::path& path,
                                  const Progress& progress) {
    CloudSummarizer summarizer;
    stream.for_each([&](std::span<const Surfel> batch) { summarizer.add(batch); });
    const CloudSummary summary = summarizer.finish();
    const std::uint64_t count = summary.usable + summary.dropped;

    BuildFileReport report;
    report.samples = summary.usable;
    report.dropped = summary.dropped;
    if (memory.limit == 0 || summary.usable == 0 || memory_to_build(count) <= memory.limit) {
        const Octree octree = build_at_once(stream, settings, count, progress);
        write_octree_file(octree.view(), path);
        report.grid = octree.grid;
        return report;
    }
    if (memory.limit < kLeastLimit) {
        throw Error(ExitCode::kBudget, "a memory limit below 64 MB is too small to build in");
    }
    if (summary.median_radius == 0.0) {
        throw Error(
            ExitCode::kBudget,
            "the points have no radius, and finding their spacing takes more memory than the "
            "limit; run `glowworm surface` first or raise --memory-limit");
    }

    // 1. Spread the surfels over tiles. Half of the room that is left goes into the buffers.
    BuildSettings tile_settings = settings;
    tile_settings.grid = fit_grid(summary, stream.origin, settings);
    tile_settings.provenance = "{}";
    const Grid& grid = report.grid = *tile_settings.grid;
    const std::uint64_t capacity = (memory.limit - kFixedBytes) / kBytesPerSurfel * 3 / 4;
    const Tiling tiling = plan_tiles(stream, summary, grid, capacity);
    const std::filesystem::path beside = path.has_parent_path() ? path.parent_path() : ".";
    const TemporaryFolder folder(memory.temporary_folder.empty() ? beside
                                                                 : memory.temporary_folder);
    std::vector<Spill> spills;
    const std::uint64_t buffered = memory.limit / 8 / sizeof(Surfel) / tiling.tiles.size();
    for (std::size_t t = 0; t < tiling.tiles.size(); ++t) {
        spills.emplace_back(folder.path() / ("spill" + std::to_string(t)),
                            std::clamp<std::uint64_t>(buffered, 16, 65536));
    }
    std::vector<std::uint32_t> reached;
    std::uint64_t done = 0;
    const auto advance = [&] {
        if (progress && ++done % 65536 == 0) progress(done / 2, count);
    };
    for_each_usable(stream, summary, [&](const Surfel& s) {
        find_tiles(s, grid, tiling, reached);
        for (const std::uint32_t tile : reached)
            spills[tile].add(s);
        report.spilled_bytes += reached.size() * sizeof(Surfel);
        advance();
    });

    // 2. Build each tile by itself, 3. join.
    std::vector<OctreeFile> built;
    for (std::size_t t = 0; t < spills.size(); ++t) {
        if (spills[t].size() == 0) continue;
        SurfelCloud cloud = empty_cloud(stream);
        const std::uint64_t size = spills[t].size();
        cloud.surfels = spills[t].take();
        tile_settings.tile = tiling.tiles[t];
        const std::filesystem::path file = folder.path() / ("tile" + std::to_string(t) + ".svo");
        write_octree_file(build_octree(cloud, tile_settings).view(), file);
        built.push_back(OctreeFile::open(file));
        done += size;
        if (progress) progress(std::min(count, done / 2), count);
    }
    report.tiles = static_cast<std::uint32_t>(built.size());
    join_octrees(built, {settings.provenance, summary.dropped}, path);
    return report;
}

}  // namespace glowworm

#include "octree/build_file.h"

#include <optional>
#include <string>
#include <utility>

#include "octree/build_in_tiles.h"
#include "octree/error.h"
#include "octree/resident_memory.h"
#include "octree/size_estimate.h"
#include "octree/write_packing.h"

namespace glowworm {
namespace {

constexpr std::uint64_t kProgramBytes = 64'000'000;  ///< code and libraries, before any work
/// Nothing where the octree turns out to need more than `room`.
std::optional<BuildFileReport> build_at_once(const SurfelStream& stream,
                                             const BuildSettings& settings, std::uint64_t room,
                                             const std::filesystem::path& path,
                                             const Progress& progress) {
    SurfelCloud cloud{stream.origin, {}, stream.stations, stream.area_lights};
    CloudSummarizer summarizer;
    cloud.surfels.reserve(stream.expected);
    stream.for_each([&](std::span<const Surfel> batch) {
        if (progress) progress(0, std::max<std::uint64_t>(stream.expected, 1));
        summarizer.add(batch);
        cloud.surfels.insert(cloud.surfels.end(), batch.begin(), batch.end());
    });
    CloudSummary summary = summarizer.finish();
    if (summary.usable > 0) {
        const Grid grid = fit_grid(summary, cloud.origin, settings);
        require_room(summary, grid, path);
        if (memory_to_build(0) + estimate_size(summary, grid).memory > room) return {};
    }
    UnpackedOctree built = build_tree(std::move(cloud), std::move(summary), settings, progress);
    built.octree.dropped_count += stream.dropped;
    return write_packing(built, path, progress, true);
}

}  // namespace

std::uint64_t memory_to_build(std::uint64_t surfels) {
    return kProgramBytes + kOwnBytes + surfels * kBytesPerSurfel;
}

BuildFileReport build_octree_file(const SurfelStream& stream, const BuildSettings& settings,
                                  const MemorySettings& memory, const std::filesystem::path& path,
                                  const Progress& progress) {
    if (settings.tile) require_tile(settings);
    if (memory.limit > 0) return build_in_tiles(stream, settings, memory, path, progress);

    const std::uint64_t room = memory_left();
    if (!settings.tile && memory_to_build(stream.expected) <= room) {
        const auto built = build_at_once(stream, settings, room, path, progress);
        if (built) return *built;
    }
    const MemorySettings left{memory_left(), memory.temporary_folder};
    return build_in_tiles(stream, settings, left, path, progress);
}

}  // namespace glowworm

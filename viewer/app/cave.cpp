#include "viewer/app/cave.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "octree/coarsen.h"
#include "octree/error.h"
#include "octree/structure.h"
#include "viewer/light/upload.h"

namespace glowworm {

namespace {

constexpr double kMiB = 1 << 20;

std::uint64_t bytes_of(const OctreeView& octree, const LightSettings& light) {
    return light_bytes(octree.nodes.size(), octree.lobes.size(), light);
}

/// What light takes at least at a level above the leaves: every cell has a lobe.
std::uint64_t least_bytes(const OctreeView& octree, std::uint32_t depth,
                          const LightSettings& light) {
    const Level& leaves = octree.levels[depth];
    return light_bytes(std::uint64_t{leaves.first_node} + leaves.node_count, leaves.node_count,
                       light);
}

/// Goes up until light fits `level.memory`.
void fit_memory(Cave& cave, const std::filesystem::path& path, const LightLevel& level) {
    const OctreeView wanted = cave.light();
    const std::uint64_t wanted_bytes = bytes_of(wanted, level.light);
    std::uint32_t depth = wanted.grid.depth;
    const std::uint32_t wanted_depth = depth;
    while (bytes_of(cave.light(), level.light) > level.memory) {
        do {
            if (depth <= 1) {
                throw Error(ExitCode::kBudget,
                            fmt::format("the light of '{}' does not fit into {:.1f} MiB at any "
                                        "level: give --light-memory more",
                                        path.string(), static_cast<double>(level.memory) / kMiB));
            }
            --depth;
        } while (depth > 1 && least_bytes(cave.points(), depth, level.light) > level.memory);
        cave.coarse = coarsen(cave.points(), depth);
    }
    if (depth == wanted_depth) return;
    const std::uint64_t bytes = bytes_of(cave.light(), level.light);
    spdlog::warn(
        "light is simulated at level {}, where it takes {:.1f} MiB: at level {} it would "
        "take {:.1f} MiB, and --light-memory allows {:.1f}",
        depth, static_cast<double>(bytes) / kMiB, wanted_depth,
        static_cast<double>(wanted_bytes) / kMiB, static_cast<double>(level.memory) / kMiB);
}

}  // namespace

Cave open_cave(const std::filesystem::path& path, const LightLevel& level) {
    Cave cave{OctreeFile::open(path), {}};
    const auto failures = check_structure(cave.points());
    cave.file.require_intact();
    if (!failures.empty()) {
        throw Error(ExitCode::kUnreadable,
                    fmt::format("'{}' is damaged: {}; `glowworm check` says all that is wrong with "
                                "it, `glowworm build` makes it anew",
                                path.string(), failures.front()));
    }
    const std::uint32_t depth = cave.points().grid.depth;
    if (level.depth && *level.depth > depth) {
        throw Error(ExitCode::kUsage,
                    fmt::format("--light-depth {} is more than the depth of '{}', which is {}",
                                *level.depth, path.string(), depth));
    }
    if (level.depth && *level.depth < depth) {
        cave.coarse = coarsen(cave.points(), *level.depth);
    }
    if (level.memory > 0) fit_memory(cave, path, level);
    if (cave.coarse) cave.file.require_intact();
    return cave;
}

void warn_of_damage(const std::filesystem::path& path, const Sentences& damage) {
    for (const std::string& sentence : damage) {
        spdlog::warn("'{}' is damaged: {}; what is shown of it may be wrong", path.string(),
                     sentence);
    }
}

}  // namespace glowworm

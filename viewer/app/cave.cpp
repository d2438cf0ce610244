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

/// How many groups of so many lobes `memory` has room for; 0 where that is too few, or any.
std::uint64_t groups_within(std::uint64_t nodes, std::uint64_t lobes, const LightSettings& light,
                            std::uint64_t memory) {
    constexpr std::uint64_t kLobesPerGroup = 5;  // with fewer groups a coarser level is better
    if (light.gather != Gather::kLinks || light.faithful) return 0;
    const std::uint64_t without = grouped_light_bytes(nodes, lobes, 0, light);
    const std::uint64_t of_group = grouped_light_bytes(0, 0, 1, light);
    const std::uint64_t groups = memory > without ? (memory - without) / of_group : 0;
    return groups * kLobesPerGroup >= lobes ? groups : 0;
}

/// Whether light may fit at a level above the leaves, where every cell has at least a lobe.
bool may_fit(const OctreeView& octree, std::uint32_t depth, const LightLevel& level) {
    const Level& leaves = octree.levels[depth];
    const std::uint64_t nodes = std::uint64_t{leaves.first_node} + leaves.node_count;
    return light_bytes(nodes, leaves.node_count, level.light) <= level.memory ||
           groups_within(nodes, leaves.node_count, level.light, level.memory) > 0;
}

/// Goes up until light fits `level.memory`.
void fit_memory(Cave& cave, const std::filesystem::path& path, const LightLevel& level) {
    const OctreeView wanted = cave.light();
    const std::uint64_t wanted_bytes = bytes_of(wanted, level.light);
    std::uint32_t depth = wanted.grid.depth;
    const std::uint32_t wanted_depth = depth;
    const double may_take = static_cast<double>(level.memory) / kMiB;
    while (bytes_of(cave.light(), level.light) > level.memory) {
        const OctreeView here = cave.light();
        cave.light_groups =
            groups_within(here.nodes.size(), here.lobes.size(), level.light, level.memory);
        if (cave.light_groups > 0) break;
        do {
            if (depth <= 1) {
                throw Error(ExitCode::kBudget,
                            fmt::format("the light of '{}' does not fit into {:.1f} MiB at any "
                                        "level: give --light-memory more",
                                        path.string(), may_take));
            }
            --depth;
        } while (depth > 1 && !may_fit(cave.points(), depth, level));
        cave.coarse = coarsen(cave.points(), depth);
    }
    const std::uint64_t bytes = bytes_of(cave.light(), level.light);
    if (cave.light_groups > 0) {
        spdlog::warn(
            "light is simulated on at most {} groups of the {} lobes of level {}, small near what "
            "is looked at: for itself each would take {:.1f} MiB in all, and --light-memory allows "
            "{:.1f}",
            cave.light_groups, cave.light().lobes.size(), depth, static_cast<double>(bytes) / kMiB,
            may_take);
    } else if (depth < wanted_depth) {
        spdlog::warn(
            "light is simulated at level {}, where it takes {:.1f} MiB: at level {} it would "
            "take {:.1f} MiB, and --light-memory allows {:.1f}",
            depth, static_cast<double>(bytes) / kMiB, wanted_depth,
            static_cast<double>(wanted_bytes) / kMiB, may_take);
    }
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

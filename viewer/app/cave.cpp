#include "viewer/app/cave.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "octree/checksums.h"
#include "octree/coarsen.h"
#include "octree/error.h"
#include "octree/structure.h"

namespace glowworm {

Cave open_cave(const std::filesystem::path& path, std::optional<std::uint32_t> light_depth) {
    Cave cave{OctreeFile::open(path), {}};
    const auto failures = check_structure(cave.points());
    cave.file.require_intact();
    if (!failures.empty()) {
        throw Error(ExitCode::kUnreadable,
                    fmt::format("'{}' is damaged: {}; `glowworm check` says all that is wrong with "
                                "it, `glowworm build` makes it anew",
                                path.string(), failures.front()));
    }
    // All of it is about to be read for the GPU: comparing checksums costs some GB a second more.
    // What was changed but stays inside can be looked at.
    for (const std::string& damage : check_checksums(cave.file)) {
        spdlog::warn("'{}' is damaged: {}; what is shown of it may be wrong", path.string(),
                     damage);
    }
    cave.file.require_intact();
    const std::uint32_t depth = cave.points().grid.depth;
    if (light_depth && *light_depth > depth) {
        throw Error(ExitCode::kUsage,
                    fmt::format("--light-depth {} is more than the depth of '{}', which is {}",
                                *light_depth, path.string(), depth));
    }
    if (light_depth && *light_depth < depth) {
        cave.coarse = coarsen(cave.points(), *light_depth);
        cave.file.require_intact();
    }
    return cave;
}

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "octree/octree.h"
#include "octree/octree_file.h"
#include "octree/rules.h"
#include "viewer/light/settings.h"

namespace glowworm {

/// The octree that is looked at: points are drawn from its file, light is simulated on its leaves
/// or on coarser ones.
struct Cave {
    OctreeFile file;
    std::optional<Octree> coarse;  ///< of the file, where light is simulated at less than its depth
    /// Most groups of lobes that reflected light is simulated on (domains.h); 0: each lobe for
    /// itself
    std::uint64_t light_groups = 0;

    const OctreeView& points() const { return file.view(); }
    OctreeView light() const { return coarse ? coarse->view() : file.view(); }
};

/// The level of light's leaves.
struct LightLevel {
    std::optional<std::uint32_t> depth;  ///< at least 1; the file's where it is empty
    std::uint64_t memory = 0;            ///< bytes that light may take on the GPU; 0: any
    LightSettings light;                 ///< what it takes depends on these
};

/// Maps `path` and looks whether every index in it stays inside, so that the GPU can follow them.
/// Where light would take more than `level.memory`, it is simulated on groups of lobes, far fewer
/// away from what is looked at, on the deepest level where there is room for enough of them; cones
/// on the deepest level where they fit. The log says so. Throws Error (kUnreadable) for what is no
/// whole and sound octree, (kUsage) where `level.depth` is more than its depth, (kBudget) where no
/// level fits the memory.
Cave open_cave(const std::filesystem::path& path, const LightLevel& level = {});

/// Logs what check_checksums said: what was changed but stays inside can be looked at.
void warn_of_damage(const std::filesystem::path& path, const Sentences& damage);

}  // namespace glowworm

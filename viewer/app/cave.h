#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "octree/octree.h"
#include "octree/octree_file.h"

namespace glowworm {

/// The octree that is looked at: points are drawn from its file, light is simulated on its leaves
/// or on coarser ones.
struct Cave {
    OctreeFile file;
    std::optional<Octree> coarse;  ///< of the file, where light is simulated at less than its depth

    const OctreeView& points() const { return file.view(); }
    OctreeView light() const { return coarse ? coarse->view() : file.view(); }
};

/// Maps `path` and looks whether every index in it stays inside, so that the GPU can follow them.
/// `light_depth` is the level of light's leaves, at least 1; the file's where it is empty. Throws
/// Error (kUnreadable) for what is no whole and sound octree, (kUsage) where light_depth is more
/// than its depth.
Cave open_cave(const std::filesystem::path& path, std::optional<std::uint32_t> light_depth = {});

}  // namespace glowworm

#pragma once

#include <filesystem>

#include "octree/build.h"
#include "octree/build_file.h"

namespace glowworm {

/// Writes an octree as write_octree_file does, packing its points on the way: no second copy of
/// them is ever in memory, and the disk has work while the next ones are packed. `progress` gets
/// the last fifth of the surfels, and may cancel. `synced`: see WriteSettings.
BuildFileReport write_packing(const UnpackedOctree& built, const std::filesystem::path& path,
                              const Progress& progress, bool synced);

}  // namespace glowworm

#pragma once

#include "octree/build_file.h"

namespace glowworm {

/// Builds an octree file within `memory.limit` bytes, which must be given: at once where that fits,
/// else what build_octree_file says. Also a tile of `settings`.
BuildFileReport build_in_tiles(const SurfelStream& stream, const BuildSettings& settings,
                               const MemorySettings& memory, const std::filesystem::path& path,
                               const Progress& progress);

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "octree/octree_file.h"
#include "octree/progress.h"

namespace glowworm {

struct JoinSettings {
    std::string provenance = "{}";              ///< JSON, the joined file's
    std::optional<std::uint64_t> dropped = {};  ///< surfels left out; else the tiles' sum
    Progress progress = {};                     ///< bytes written
};

/// Joins tiles of one grid (see BuildSettings::tile) and writes one octree: the same bytes as one
/// build of all their points. Everything below the tiles is copied, Morton order makes that a
/// concatenation; only the levels above them and chunks that span several small tiles are made
/// anew. Memory grows with the number of tiles, not with their size. Links are left out: light
/// crosses tiles. Throws Error (kUsage) for tiles of different grids or tables and for tiles that
/// overlap, (kDegenerate) for none, and as write_octree_file does.
void join_octrees(std::span<const OctreeFile> tiles, const JoinSettings& settings,
                  const std::filesystem::path& path);

}  // namespace glowworm

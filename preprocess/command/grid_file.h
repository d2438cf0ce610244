#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "octree/grid.h"

namespace glowworm {

/// `{"origin":[x,y,z],"cube_min":[x,y,z],"cube_edge":m,"depth":n}`: the root cube and leaf level
/// that all tiles of one cave share. Numbers are written so that they come back to the bit.
nlohmann::ordered_json grid_json(const Grid& grid);

/// From an .svo, or from JSON that is a grid or has one under "grid", as `build --dry-run --json`
/// and `info --json` print it. Throws Error (kUnreadable) where there is none.
Grid read_grid(const std::filesystem::path& path);

/// A cell from its key: the octants (x + 2y + 4z) on the way from the root, one digit 0..7 a level;
/// an r before them is allowed, "r" alone is the root. Throws Error (kUsage).
OctreeCell parse_cell(const std::string& key);

}  // namespace glowworm

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "octree/octree_file.h"
#include "octree/structure.h"

namespace glowworm {

/// Every invariant of an octree, in parallel: levels, children, lobes, attributes,
/// totals, chunks, points, tables, links. One sentence per kind of failure, with where it is first
/// met and how often; empty where all is well. Reads nothing outside the spans, whatever they hold.
std::vector<std::string> check_octree(const OctreeView& octree);

/// Opens `path`, compares every checksum, then check_octree. An octree file that is too damaged to
/// be opened is one sentence too. Throws Error (kUnreadable) where `path` is no octree file of this
/// version (is_octree_of_this_version): nothing is wrong with it then.
std::vector<std::string> check_octree_file(const std::filesystem::path& path);

}  // namespace glowworm

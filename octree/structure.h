#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octree/octree_file.h"
#include "octree/rules.h"

namespace glowworm {

/// Whether every index in an octree stays inside: children, lobes, chunks, names, lights, links.
/// What a program that follows them without looking must ask first; some milliseconds per million
/// nodes. Sentences as check_octree.
std::vector<std::string> check_structure(const OctreeView& octree);

/// Codes of the leaves of a tree whose every index stays inside, else nothing and a sentence.
std::vector<std::uint64_t> follow_tree(const OctreeView& octree, Sentences& sentences);

/// Chunks, points, names, lights and links stay inside their sections.
void check_ranges(const OctreeView& octree, Sentences& sentences);

}  // namespace glowworm

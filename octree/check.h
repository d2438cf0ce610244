#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

/// Whether every index in an octree stays inside: children, lobes, chunks, names, lights, links.
/// What a program that follows them without looking must ask first; some milliseconds per million
/// nodes. Sentences as check_octree.
std::vector<std::string> check_structure(const OctreeView& octree);

/// Every invariant of an octree, in parallel: levels, children, lobes, attributes,
/// totals, chunks, points, tables, links. One sentence per kind of failure, with where it is first
/// met and how often; empty where all is well. Reads nothing outside the spans, whatever they hold.
std::vector<std::string> check_octree(const OctreeView& octree);

/// Opens `path`, compares every checksum, then check_octree. A file that cannot be opened is one
/// sentence too. Never throws for what is in the file; throws Error (kUnreadable) only where there
/// is no regular file to read.
std::vector<std::string> check_octree_file(const std::filesystem::path& path);

}  // namespace glowworm

#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace glowworm {

/// Hash of which files these are and when they last changed (device, inode, size, times of content
/// and of status) and of `settings`: as long as it is the same, no file's content need be hashed.
/// Empty where one changed less than two seconds ago, so that its times might not tell another
/// change apart.
std::string state_of(std::span<const std::filesystem::path> files, const std::string& settings);

/// Keeps the state of the inputs with the output, as an extended attribute: outside its content,
/// gone with it. Where the file system has none, contents are hashed every time.
void remember_state(const std::filesystem::path& output, const std::string& state);

/// What was remembered, empty where nothing was.
std::string remembered_state(const std::filesystem::path& output);

/// The provenance of an octree file; empty for what is none.
std::string provenance_of(const std::filesystem::path& output);

}  // namespace glowworm

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

/// What is told of the inputs: their state, or the hash of their content and of the settings.
enum class Record { kState, kContent };

/// Keeps `value` with the output, as an extended attribute: outside its content, gone with it. An
/// output that changes afterwards forgets it. Where the file system has no such attributes, or the
/// value is empty, nothing is kept.
void remember_as(const std::filesystem::path& output, Record record, const std::string& value);

/// Whether this value was kept, and the output has not changed since. Never for an empty one.
bool remembers(const std::filesystem::path& output, Record record, const std::string& value);

/// The provenance of an octree file; empty for what is none.
std::string provenance_of(const std::filesystem::path& output);

}  // namespace glowworm

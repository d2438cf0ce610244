#pragma once

#include <filesystem>
#include <initializer_list>
#include <vector>

namespace glowworm {

/// Throws Error before any work, not an hour into it: kUsage where `path` is a folder or a device,
/// kExists where it is there and `force` is not set, kUnreadable where its folder is not there or
/// may not be written.
void require_writable_output(const std::filesystem::path& path, bool force);

/// Throws Error (kUsage) where `output` is one of the `inputs`, by whatever name.
void require_distinct(const std::filesystem::path& output,
                      const std::vector<std::filesystem::path>& inputs);

/// Throws Error (kUnreadable) where `path` is not a regular file: a pipe would be waited for, a
/// device read without end.
void require_regular_input(const std::filesystem::path& path);

}  // namespace glowworm

#pragma once

#include <filesystem>
#include <string>

namespace glowworm {

/// Says that the temporary file or folder open as `descriptor` is in use, until it is closed or the
/// program ends, however it ends.
void hold(int descriptor);

/// Whether some program holds the file or folder, or it cannot be opened to find out.
bool is_held(const std::filesystem::path& path);

/// Removes what killed programs left behind: files and folders in `folder` whose names begin with
/// `prefix` and contain `mark`, that nobody holds and nobody has changed for a minute. Failures are
/// passed over: another program may be doing the same.
void remove_stale(const std::filesystem::path& folder, const std::string& prefix,
                  const std::string& mark = {});

/// Removes in the same way what killed programs left of files with names such as partial_name
/// makes: once for each folder in the life of this program, however many files it writes there.
void remove_stale_partials(const std::filesystem::path& folder);

/// A name for the unfinished file of `name`, another one each time: ".name.PID.N.partial.ending".
std::string partial_name(const std::filesystem::path& name);

}  // namespace glowworm

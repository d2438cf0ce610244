#include "viewer/app/frame_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "octree/error.h"
#include "octree/output_path.h"
#include "octree/stale_files.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;

/// "frames/" is "frames".
fs::path without_slash(const fs::path& path) {
    return path.has_filename() ? path : path.parent_path();
}

bool is_frame(const fs::path& path) {
    const std::string stem = path.stem().string(), ending = path.extension().string();
    return stem.size() >= 6 && (ending == ".png" || ending == ".exr") &&
           std::all_of(stem.begin(), stem.end(),
                       [](unsigned char c) { return std::isdigit(c) != 0; });
}

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
    throw Error(ExitCode::kUnreadable,
                fmt::format("the folder '{}' cannot be written: {}", path.string(), why));
}

/// The names of the frames in a folder.
std::set<fs::path> frames_in(const fs::path& folder) {
    std::set<fs::path> names;
    std::error_code failure;
    for (fs::directory_iterator at(folder, failure), end; !failure && at != end;
         at.increment(failure)) {
        if (is_frame(at->path())) names.insert(at->path().filename());
    }
    if (failure) fail(folder, failure.message());
    return names;
}

constexpr const char* kMark = ".partial";

std::string prefix_of(const fs::path& output) {
    return fmt::format(".{}.", output.filename().string());
}

/// A new folder in `parent` for the frames of `output` until all are there.
fs::path make_unfinished(const fs::path& parent, const fs::path& output) {
    const std::string prefix = prefix_of(output);
    // A killed flight may have had our process id, and still count as somebody's.
    for (int number = 0;; ++number) {
        const fs::path path = parent / fmt::format("{}{}.{}{}", prefix, ::getpid(), number, kMark);
        std::error_code failure;
        if (fs::create_directory(path, failure)) return path;
        if (failure) fail(output, failure.message());
    }
}

}  // namespace

void FrameFolder::require_writable(const fs::path& output, bool force) {
    const fs::path path = without_slash(output);
    std::error_code ignored;
    if (!fs::is_directory(path, ignored)) {
        if (fs::exists(path, ignored)) {
            throw Error(ExitCode::kUsage,
                        fmt::format("the output '{}' is a file; name a folder for the frames, or "
                                    "a video (.mp4, .mov, .mkv)",
                                    path.string()));
        }
        require_writable_output(path, force);
        return;
    }
    if (::access(path.c_str(), W_OK | X_OK) != 0) fail(path, "its permissions forbid it");
    if (!force && !frames_in(path).empty()) {
        throw Error(ExitCode::kExists,
                    fmt::format("the folder '{}' holds frames already; --force replaces them",
                                path.string()));
    }
}

FrameFolder::FrameFolder(const fs::path& path, const std::string& ending)
    : path_(without_slash(path)), ending_(ending), existed_(fs::is_directory(path_)) {
    const fs::path beside = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
    // What killed flights left lies where the folder was not there yet, or in it.
    remove_stale(beside, prefix_of(path_), kMark);
    if (existed_) remove_stale(path_, prefix_of(path_), kMark);
    unfinished_ = make_unfinished(existed_ ? path_ : beside, path_);
    descriptor_ = ::open(unfinished_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ >= 0) hold(descriptor_);
}

FrameFolder::~FrameFolder() {
    std::error_code ignored;
    fs::remove_all(unfinished_, ignored);
    if (descriptor_ >= 0) ::close(descriptor_);
}

fs::path FrameFolder::frame(int number) const {
    return unfinished_ / fmt::format("{:06}{}", number, ending_);
}

void FrameFolder::finish() const {
    std::error_code failure;
    if (!existed_) {
        fs::rename(unfinished_, path_, failure);
        if (failure) fail(path_, failure.message());
        return;
    }
    const std::set<fs::path> frames = frames_in(unfinished_), old = frames_in(path_);
    // Each takes its predecessor's place at once: no frame is ever missing.
    for (const fs::path& frame : frames) {
        fs::rename(unfinished_ / frame, path_ / frame, failure);
        if (failure) fail(path_, failure.message());
    }
    for (const fs::path& frame : old) {
        if (frames.contains(frame)) continue;
        fs::remove(path_ / frame, failure);
        if (failure) fail(path_, failure.message());
    }
}

}  // namespace glowworm

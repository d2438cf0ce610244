#include "viewer/app/frame_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "octree/error.h"
#include "octree/output_path.h"

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

/// The frames of an earlier flight.
std::vector<fs::path> frames_in(const fs::path& folder) {
    std::vector<fs::path> frames;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        if (is_frame(entry.path())) frames.push_back(entry.path());
    }
    return frames;
}

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
    throw Error(ExitCode::kUnreadable,
                fmt::format("the folder '{}' cannot be written: {}", path.string(), why));
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
    const std::string hidden = fmt::format(".{}.{}.partial", path_.filename().string(), ::getpid());
    unfinished_ = (existed_ ? path_ : path_.parent_path()) / hidden;
    std::error_code failure;
    fs::create_directory(unfinished_, failure);
    if (failure) fail(path_, failure.message());
}

FrameFolder::~FrameFolder() {
    std::error_code ignored;
    fs::remove_all(unfinished_, ignored);
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
    for (const fs::path& old : frames_in(path_))
        fs::remove(old, failure);
    for (const fs::path& frame : frames_in(unfinished_)) {
        fs::rename(frame, path_ / frame.filename(), failure);
        if (failure) fail(path_, failure.message());
    }
}

}  // namespace glowworm

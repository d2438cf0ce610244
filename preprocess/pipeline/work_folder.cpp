#include "preprocess/pipeline/work_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <vector>

#include "octree/error.h"
#include "octree/stale_files.h"
#include "preprocess/pipeline/hash.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLock = "lock";
constexpr const char* kPart = ".part";
constexpr int kAttempts = 50;
constexpr useconds_t kPause = 20'000;  // µs

std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code problem;
    for (fs::directory_iterator entry(folder, problem), end; !problem && entry != end;
         entry.increment(problem))
        files.push_back(entry->path());
    return files;
}

/// A file of AtomicFile's that no rename has made whole yet.
bool is_unfinished(const fs::path& path) {
    const std::string name = path.filename().string();
    return name.starts_with('.') && name.find(".partial") != std::string::npos;
}

[[noreturn]] void refuse(const fs::path& path, int error) {
    throw Error(ExitCode::kUnreadable,
                fmt::format("cannot make the work folder '{}': {}; choose another place with "
                            "--temp-dir",
                            path.string(), std::strerror(error)));
}

void require_ours(const fs::path& path) {
    std::error_code ignored;
    const bool ours = fs::is_directory(path, ignored) &&
                      (fs::exists(path / kLock, ignored) || fs::is_empty(path, ignored));
    if (ours) return;
    throw Error(ExitCode::kExists,
                fmt::format("'{}' is there and no work folder of a conversion; move it away or "
                            "choose another place with --temp-dir",
                            path.string()));
}

/// Whether the file could be locked. One that is held is asked for again during a second: who ends
/// a run that read scans holds the folder alone for a moment, to see whether it may go.
bool lock_patiently(int file, int kind) {
    for (int attempt = 0; ::flock(file, kind | LOCK_NB) != 0; ++attempt) {
        if (errno != EWOULDBLOCK || attempt == kAttempts) return false;
        ::usleep(kPause);
    }
    return true;
}

/// The descriptor of the locked file; -1 where it vanished meanwhile, because another run ended.
int try_lock(const fs::path& folder, WorkFolder::Hold hold) {
    if (::mkdir(folder.c_str(), 0777) != 0) {
        if (errno != EEXIST) refuse(folder, errno);
        require_ours(folder);
    }
    const int lock = ::open((folder / kLock).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock < 0) {
        if (errno == ENOENT) return -1;
        refuse(folder, errno);
    }
    const int kind = hold == WorkFolder::Hold::kAlone ? LOCK_EX : LOCK_SH;
    if (!lock_patiently(lock, kind)) {
        const int error = errno;
        ::close(lock);
        if (error != EWOULDBLOCK) refuse(folder, error);
        throw Error(ExitCode::kExists,
                    fmt::format("another run is working in '{}' now; wait for it to end or choose "
                                "another output",
                                folder.string()));
    }
    struct stat status = {};
    if (::fstat(lock, &status) == 0 && status.st_nlink > 0) return lock;
    ::close(lock);
    return -1;
}

}  // namespace

fs::path work_folder_of(const fs::path& output, const fs::path& temp_dir) {
    if (temp_dir.empty()) return output.string() + ".work";
    std::error_code ignored;
    const fs::path whole = fs::weakly_canonical(fs::absolute(output, ignored), ignored);
    return temp_dir / fmt::format("{}.{}.work", output.filename().string(),
                                  Hash().add(whole.string()).hex().substr(0, 12));
}

void remove_abandoned(const fs::path& output) {
    const std::string start = "." + output.filename().string() + ".";
    for (const fs::path& file : files_in(output.has_parent_path() ? output.parent_path() : ".")) {
        const std::string name = file.filename().string();
        if (!name.starts_with(start) || !is_unfinished(file)) continue;
        int process = 0;
        const char* digits = name.data() + start.size();
        if (std::from_chars(digits, name.data() + name.size(), process).ec != std::errc()) continue;
        // No process of that number here may still be one on another machine, which holds its file.
        const bool gone = process > 0 && ::kill(process, 0) != 0 && errno == ESRCH;
        std::error_code ignored;
        if (gone && !is_held(file)) fs::remove(file, ignored);
    }
}

WorkFolder::WorkFolder(const fs::path& output, const fs::path& temp_dir, Hold hold)
    : path_(work_folder_of(output, temp_dir)) {
    for (int attempt = 0; lock_ < 0 && attempt < 100; ++attempt)
        lock_ = try_lock(path_, hold);
    if (lock_ < 0) refuse(path_, ENOENT);
    if (hold == Hold::kShared) return;
    for (const fs::path& file : files_in(path_)) {
        std::error_code ignored;
        if (is_unfinished(file)) fs::remove(file, ignored);
    }
}

WorkFolder::~WorkFolder() {
    if (!keeps_anything() && ::flock(lock_, LOCK_EX | LOCK_NB) == 0) remove();
    ::close(lock_);
}

std::vector<std::string> WorkFolder::parts() const {
    std::vector<std::string> names;
    for (const fs::path& file : files_in(path_)) {
        if (file.extension() == kPart && !is_unfinished(file))
            names.push_back(file.stem().string());
    }
    std::ranges::sort(names);
    return names;
}

void WorkFolder::remove() const {
    std::error_code ignored;
    for (const fs::path& file : files_in(path_)) {
        if (file.filename() != kLock) fs::remove(file, ignored);
    }
    fs::remove(path_ / kLock, ignored);
    fs::remove(path_, ignored);
}

}  // namespace glowworm

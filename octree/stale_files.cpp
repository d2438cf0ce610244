#include "octree/stale_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <system_error>
#include <vector>

namespace glowworm {
namespace {

constexpr auto kSettled = std::chrono::minutes(1);  ///< long after whoever made it holds it

}  // namespace

bool is_held(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return true;
    const bool free = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
    ::close(descriptor);
    return !free;
}

void hold(int descriptor) {
    ::flock(descriptor, LOCK_EX | LOCK_NB);
}

void remove_stale(const std::filesystem::path& folder, const std::string& prefix,
                  const std::string& mark) {
    std::error_code ignored;
    std::vector<std::filesystem::path> stale;
    const auto now = std::filesystem::file_time_type::clock::now();
    for (std::filesystem::directory_iterator at(folder, ignored), end; at != end && !ignored;
         at.increment(ignored)) {
        const std::string name = at->path().filename().string();
        if (!name.starts_with(prefix) || name.find(mark) == std::string::npos) continue;
        std::error_code gone;
        const auto changed = std::filesystem::last_write_time(at->path(), gone);
        if (!gone && now - changed > kSettled && !is_held(at->path())) stale.push_back(at->path());
    }
    for (const auto& path : stale)
        std::filesystem::remove_all(path, ignored);
}

}  // namespace glowworm

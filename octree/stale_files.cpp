#include "octree/stale_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>
#include <vector>

namespace glowworm {
namespace {

constexpr auto kSettled = std::chrono::minutes(1);  ///< long after whoever made it holds it
constexpr const char* kPartial = ".partial";

bool is_number(std::string_view text) {
    return !text.empty() &&
           std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Takes what follows the last dot, and the dot.
std::string_view take_last(std::string_view& name) {
    const std::size_t dot = std::min(name.rfind('.'), name.size());
    const std::string_view last = name.substr(std::min(dot + 1, name.size()));
    name = name.substr(0, dot);
    return last;
}

bool is_partial_name(std::string_view name) {
    const std::size_t mark = name.rfind(kPartial);
    if (mark == std::string_view::npos || !name.starts_with('.')) return false;
    name = name.substr(0, mark);
    return is_number(take_last(name)) && is_number(take_last(name)) && name.size() > 1;
}

/// Removes what is named as `is_ours` says and was left behind.
template <typename IsOurs>
void remove_left(const std::filesystem::path& folder, const IsOurs& is_ours) {
    std::error_code ignored;
    std::vector<std::filesystem::path> stale;
    const auto now = std::filesystem::file_time_type::clock::now();
    for (std::filesystem::directory_iterator at(folder, ignored), end; at != end && !ignored;
         at.increment(ignored)) {
        if (!is_ours(at->path().filename().string())) continue;
        std::error_code gone;
        const auto changed = std::filesystem::last_write_time(at->path(), gone);
        if (!gone && now - changed > kSettled && !is_held(at->path())) stale.push_back(at->path());
    }
    for (const auto& path : stale)
        std::filesystem::remove_all(path, ignored);
}

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
    remove_left(folder, [&](const std::string& name) {
        return name.starts_with(prefix) && name.find(mark) != std::string::npos;
    });
}

void remove_stale_partials(const std::filesystem::path& folder) {
    static std::mutex mutex;
    static std::set<std::filesystem::path> done;
    std::error_code ignored;
    {
        const std::lock_guard lock(mutex);
        if (!done.insert(std::filesystem::absolute(folder, ignored)).second) return;
    }
    remove_left(folder, is_partial_name);
}

std::string partial_name(const std::filesystem::path& name) {
    static std::atomic<unsigned> counter{0};
    return "." + name.string() + "." + std::to_string(::getpid()) + "." +
           std::to_string(counter++) + kPartial + name.extension().string();
}

}  // namespace glowworm

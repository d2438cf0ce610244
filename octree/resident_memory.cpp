#include "octree/resident_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

namespace glowworm {
namespace {

constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();

/// Of /proc/self/statm, in bytes.
struct Occupied {
    std::uint64_t address_space = 0, resident = 0, data = 0;
};

Occupied occupied() {
    std::uint64_t total = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
    std::ifstream stream("/proc/self/statm");
    if (!(stream >> total >> resident >> shared >> text >> library >> data)) return {};
    const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    return {total * page, resident * page, data * page};
}

std::uint64_t left_of(std::uint64_t limit, std::uint64_t used) {
    return limit - std::min(limit, used);
}

std::uint64_t left_of_system() {
    std::ifstream stream("/proc/meminfo");
    std::string name, unit;
    for (std::uint64_t kilobytes = 0; stream >> name >> kilobytes;) {
        if (name == "MemAvailable:") return kilobytes * 1024;
        std::getline(stream, unit);
    }
    return kAny;
}

/// A number in a file of its own; without end where there is none ("max").
std::uint64_t number_in(const std::filesystem::path& file) {
    std::uint64_t number = 0;
    return std::ifstream(file) >> number ? number : kAny;
}

/// In the control groups, version 2, that this program is in: its own and all around it.
std::uint64_t left_of_groups() {
    std::uint64_t left = kAny;
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        if (!line.starts_with("0::/")) continue;
        const std::filesystem::path root = "/sys/fs/cgroup";
        for (auto group = root / line.substr(4);; group = group.parent_path()) {
            const std::uint64_t limit = number_in(group / "memory.max");
            if (limit != kAny)
                left = std::min(left, left_of(limit, number_in(group / "memory.current")));
            if (group == root || !group.has_relative_path()) break;
        }
    }
    return left;
}

std::uint64_t left_of_limit(int resource, std::uint64_t used) {
    struct rlimit limit = {};
    if (::getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0) return kAny;
    return limit.rlim_cur == RLIM_INFINITY ? kAny : left_of(limit.rlim_cur, used);
}

}  // namespace

std::uint64_t resident_bytes() {
    return occupied().resident;
}

std::uint64_t memory_left() {
    const Occupied now = occupied();
    const std::uint64_t left =
        std::min({left_of_system(), left_of_groups(), left_of_limit(RLIMIT_DATA, now.data),
                  left_of_limit(RLIMIT_AS, now.address_space)});
    return left == kAny ? kAny : now.resident + left / 10 * 9;
}

}  // namespace glowworm

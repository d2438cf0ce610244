#include "preprocess/command/loader_pages.h"

#include <sys/mman.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace glowworm {
namespace {

/// A mapping as /proc/self/smaps tells of it.
struct Mapping {
    std::uintptr_t begin = 0, end = 0;
    bool of_file = false, writable = false;
    std::uint64_t changed = 0;  ///< kB that the file does not have: relocated tables, even where
                                ///< they may not be written any more
};

/// Whether the line begins a mapping: "7f00-7fff r-xp 00000000 fe:00 1234   /usr/lib/...".
bool begins_mapping(const std::string& line, Mapping& mapping) {
    std::istringstream words(line);
    std::string permissions, offset, device;
    std::uint64_t inode = 0;
    char dash = 0;
    words >> std::hex >> mapping.begin >> dash >> mapping.end >> permissions >> offset >> device >>
        std::dec >> inode;
    if (!words || dash != '-' || permissions.size() != 4) return false;
    mapping.of_file = inode != 0 && permissions[3] == 'p';
    mapping.writable = permissions[1] == 'w';
    mapping.changed = 0;
    return true;
}

std::vector<Mapping> mappings_of_program() {
    std::vector<Mapping> all;
    std::ifstream stream("/proc/self/smaps");
    Mapping next;
    for (std::string line; std::getline(stream, line);) {
        if (begins_mapping(line, next)) {
            all.push_back(next);
        } else if (!all.empty() && (line.starts_with("Anonymous:") || line.starts_with("Swap:"))) {
            all.back().changed += std::stoull(line.substr(line.find(':') + 1));
        }
    }
    return all;
}

}  // namespace

void forget_loader_pages() {
    for (const Mapping& mapping : mappings_of_program()) {
        if (!mapping.of_file || mapping.writable || mapping.changed > 0) continue;
        ::madvise(reinterpret_cast<void*>(mapping.begin), mapping.end - mapping.begin,
                  MADV_DONTNEED);
    }
}

}  // namespace glowworm

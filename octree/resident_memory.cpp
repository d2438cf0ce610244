#include "octree/resident_memory.h"

#include <unistd.h>

#include <fstream>
#include <string>

namespace glowworm {

std::uint64_t resident_bytes() {
    std::uint64_t total = 0, resident = 0;
    if (!(std::ifstream("/proc/self/statm") >> total >> resident)) return 0;
    return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t available_bytes() {
    std::ifstream stream("/proc/meminfo");
    std::string name, unit;
    for (std::uint64_t kilobytes = 0; stream >> name >> kilobytes;) {
        if (name == "MemAvailable:") return kilobytes * 1024;
        std::getline(stream, unit);
    }
    return 0;
}

}  // namespace glowworm

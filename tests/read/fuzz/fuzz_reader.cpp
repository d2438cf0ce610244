#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "octree/error.h"
#include "preprocess/read/registry.h"

// The entry of libFuzzer for the reader that GLOWWORM_FUZZ_FORMAT names in the registry. The reader
// gets every input, recognised or not, and may end in points or in an Error and in nothing else.

namespace {

using namespace glowworm;

/// A file in memory of these bytes; the path stays the same.
std::string memory_file(const std::uint8_t* data, std::size_t size) {
    static const int descriptor = ::memfd_create("scan", MFD_CLOEXEC);
    if (::ftruncate(descriptor, 0) != 0 ||
        ::pwrite(descriptor, data, size, 0) != static_cast<ssize_t>(size)) {
        std::abort();
    }
    return "/proc/self/fd/" + std::to_string(descriptor);
}

void read_all(ScanFile& file) {
    ScanHeader header;
    PointBlock block;
    while (file.next_scan(header)) {
        while (file.next_block(block)) {
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto format = std::ranges::find(scan_formats(), std::string_view(GLOWWORM_FUZZ_FORMAT),
                                          &ScanFormat::name);
    if (format == scan_formats().end()) std::abort();
    const std::string path = memory_file(data, size);
    for (const bool check_crc : {true, false}) {
        try {
            const ReadSettings settings{.check_crc = check_crc, .columns = "", .delimiter = '\0'};
            read_all(*format->open(InputFile(path), settings));
        } catch (const Error&) {
        }
    }
    return 0;
}

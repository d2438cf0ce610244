#pragma once

#include <sys/mman.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstddef>
#include <cstring>
#include <span>
#include <string>

#include "octree/check.h"
#include "octree/coarsen.h"
#include "octree/error.h"
#include "octree/extract.h"
#include "octree/statistics.h"
#include "octree/tables.h"

namespace glowworm::testing {

/// Does with hostile bytes what our programs do with an .svo: opens and checks it, and where the
/// structure is sound uses everything. The header's checksum and length are put right first, so
/// that what lies behind them is reached. Returns whether the file could be opened.
inline bool try_octree_bytes(std::span<const unsigned char> bytes) {
    std::string file(bytes.begin(), bytes.end());
    if (file.size() >= kSectionAlignment) {
        const std::uint64_t size = file.size();
        std::memcpy(file.data() + offsetof(FileHeader, file_bytes), &size, sizeof size);
        const std::uint64_t hash = XXH3_64bits(file.data(), offsetof(FileHeader, checksum));
        std::memcpy(file.data() + offsetof(FileHeader, checksum), &hash, sizeof hash);
    }
    const int memory = ::memfd_create("octree", 0);
    const std::string path = "/proc/self/fd/" + std::to_string(memory);
    bool opened = false;
    if (::write(memory, file.data(), file.size()) == static_cast<ssize_t>(file.size())) {
        try {
            check_octree_file(path);
            const OctreeFile octree = OctreeFile::open(path);
            opened = true;
            read_stations(octree.view());
            read_area_lights(octree.view());
            if (check_structure(octree.view()).empty()) {
                measure_octree(octree.view(), octree.bytes());
                coarsen(octree.view(), octree.view().grid.depth / 2);
                extract_level(octree.view(), octree.view().grid.depth);
                const float edge = octree.view().grid.cube_edge;
                const Vec3f corner = octree.view().grid.cube_min;
                cut_box(octree.view(), {corner, corner + Vec3f{edge, edge, edge}});
            }
        } catch (const Error&) {
            // Refused with a sentence: what is asked of it.
        }
    }
    ::close(memory);
    return opened;
}

}  // namespace glowworm::testing

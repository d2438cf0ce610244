#include "viewer/frame/surfel_pages.h"

#include <algorithm>

#include "octree/error.h"
#include "viewer/frame/selection.h"

namespace glowworm {

SurfelPages::SurfelPages(const OctreeView& octree, std::size_t max_page_bytes,
                         std::uint64_t max_bytes) {
    const std::uint64_t all_bytes = octree.surfels.size_bytes();
    if (max_bytes > 0 && all_bytes > max_bytes) {
        resident_ = static_cast<double>(max_bytes) / static_cast<double>(all_bytes);
    }
    const std::size_t page_surfels =
        std::min(max_page_bytes, std::size_t{64} << 20) / sizeof(PackedSurfel);
    std::vector<std::size_t> page_counts;
    for (const Chunk& chunk : octree.chunks) {
        const std::uint32_t count = share_of(chunk, resident_);
        if (count > page_surfels) {
            throw Error(ExitCode::kUnreadable,
                        "the octree has a chunk of more points than the GPU can show at once; "
                        "build it again with this version of glowworm");
        }
        if (page_counts.empty() || page_counts.back() + count > page_surfels) {
            page_counts.push_back(0);
        }
        places_.push_back({static_cast<std::uint32_t>(page_counts.size() - 1),
                           static_cast<std::uint32_t>(page_counts.back())});
        page_counts.back() += count;
    }

    for (const std::size_t count : page_counts) {
        pages_.emplace_back("surfel page", count * sizeof(PackedSurfel));
    }
    for (std::size_t i = 0; i < octree.chunks.size(); ++i) {
        const Chunk& chunk = octree.chunks[i];
        pages_[places_[i].page].write(
            octree.surfels.subspan(chunk.first, share_of(chunk, resident_)), places_[i].first);
    }
}

}  // namespace glowworm

#pragma once

#include <cstdint>
#include <vector>

#include "octree/octree_file.h"
#include "viewer/gpu/objects.h"

namespace glowworm {

/// The cloud on the GPU: whole chunks in pages that one storage binding can show.
class SurfelPages {
  public:
    struct Place {
        std::uint32_t page;
        std::uint32_t first;  ///< surfel, counted from the page's start
    };

    SurfelPages() = default;
    /// Copies the first surfels of every chunk of `octree`: all of them, or an even share where
    /// `max_bytes` do not hold them (0: no limit). `max_page_bytes` is the context's limit for one
    /// binding. Throws Error (kUnreadable) where a single chunk exceeds it.
    SurfelPages(const OctreeView& octree, std::size_t max_page_bytes, std::uint64_t max_bytes = 0);

    /// Share of each chunk that is here, (0, 1].
    double resident() const { return resident_; }

    const std::vector<Buffer>& pages() const { return pages_; }
    Place place_of(std::uint32_t chunk) const { return places_[chunk]; }

  private:
    double resident_ = 1.0;
    std::vector<Buffer> pages_;
    std::vector<Place> places_;  ///< [chunks]
};

}  // namespace glowworm

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shaders/frame_layout.h"
#include "viewer/gpu/objects.h"

namespace glowworm {

/// A range of the batches, all of whose surfels lie in one page.
struct PageDraw {
    std::size_t page;
    std::uint32_t first_batch, batch_count;
};

/// What a frame draws. Growing while it is drawn: nothing of it changes but at the ends.
struct SplatInput {
    std::span<const gpu::DrawnChunk> chunks;
    std::span<const gpu::SplatBatch> batches;
    std::span<const PageDraw> draws;
    std::span<const Buffer> pages;  ///< PackedSurfel
};

}  // namespace glowworm

#pragma once

#include <cstddef>
#include <memory>

#include "preprocess/read/laz_chunks.h"

namespace glowworm {

/// The points of one chunk in order, as the records of an uncompressed LAS file.
class LazChunkDecoder {
  public:
    virtual ~LazChunkDecoder() = default;

    /// Begins with `chunk`.
    virtual void start(const LazChunk& chunk) = 0;

    /// The next record, of layout.record_bytes bytes. Throws Error (kUnreadable) where the chunk's
    /// bytes end before its points.
    virtual void next(std::byte* record) = 0;
};

/// Point formats 0 to 5: the items of a point one after the other in a single stream.
std::unique_ptr<LazChunkDecoder> make_pointwise_decoder(const InputFile& file,
                                                        const LazLayout& layout);

}  // namespace glowworm

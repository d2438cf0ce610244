#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "preprocess/read/las_header.h"
#include "preprocess/read/laz_layered.h"

namespace glowworm {

/// The points of a LAS or LAZ file as uncompressed records, one after the other.
class LasRecordStream {
  public:
    virtual ~LasRecordStream() = default;

    /// The next `count` records, of header.record_bytes bytes each. At most header.point_count
    /// together. Throws Error (kUnreadable) for what is damaged.
    virtual void read(std::byte* records, std::size_t count) = 0;

    /// The version of the LASzip that compressed them; empty where they are not.
    virtual std::string compression() const { return {}; }
};

/// Both arguments must outlive the stream. Compressed attributes outside `wanted` may be left as
/// they are at an earlier point.
std::unique_ptr<LasRecordStream> open_las_records(const InputFile& file, const LasHeader& header,
                                                  const LazLayers& wanted);

}  // namespace glowworm

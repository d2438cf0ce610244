#pragma once

#include <memory>

#include "preprocess/read/laz_pointwise.h"

namespace glowworm {

/// Which attributes of a point are decoded. Those that are not keep what the first point of their
/// chunk has. Position and returns always are.
struct LazLayers {
    bool flags = true;           ///< classification flags (withheld ...), direction, edge
    bool classification = true;  ///< and scan angle, user data and source
    bool intensity = true;
    bool gps_time = true;
    bool colour = true;  ///< red, green, blue
    bool infrared = true;
    bool extra_bytes = true;
};

/// Point formats 6 to 10: every attribute of a chunk's points in a stream of its own, so that what
/// nobody asked for is not even read. Wave packets are passed over.
std::unique_ptr<LazChunkDecoder> make_layered_decoder(const InputFile& file,
                                                      const LazLayout& layout,
                                                      const LazLayers& wanted);

}  // namespace glowworm

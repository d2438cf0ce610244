#pragma once

#include <cstdint>
#include <filesystem>

#include "octree/surfel_stream.h"
#include "preprocess/read/scan_file.h"
#include "preprocess/surface/surfel_points.h"

namespace glowworm {

/// What `build` builds from: a cloud with normals as surfels.
struct SurfelFile {
    SurfelStream stream;
    SurfelDefaults defaults;
    bool in_memory = false;  ///< the stream reads from memory, not from the file
};

/// Opens a cloud of any format that has normals. A single cloud with radii and colours (as `merge`
/// and `surface` write it) is read from the file each time the stream is asked for; what needs a
/// look at the whole cloud first (radii from the spacing, grey from intensities, several scans) is
/// read into memory. Either way the same surfels come in the same order. Throws Error as read_cloud
/// and to_surfels do, and kBudget where it would have to be in memory and takes more than
/// `memory_limit` bytes (0: no limit).
SurfelFile open_surfels(const std::filesystem::path& path, const ReadSettings& settings,
                        float default_albedo, std::uint64_t memory_limit = 0);

}  // namespace glowworm

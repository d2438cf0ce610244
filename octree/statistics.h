#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

struct LevelStatistics {
    std::uint32_t level = 0;
    std::uint64_t nodes = 0;
    double occupied_fraction = 0.0;  ///< of the 8^level cells
    double mean_children = 0.0;      ///< 0 for leaves
    double mean_opacity = 0.0;
    double mean_ndf_length = 0.0;
    std::uint64_t bytes = 0;  ///< nodes and attributes; for leaves their lobes as well
};

/// Bin i counts values in [edges[i], edges[i + 1]), the last one its upper edge too. Values outside
/// are counted in the nearest bin.
struct Histogram {
    std::vector<double> edges;          ///< [bins + 1]
    std::vector<std::uint64_t> counts;  ///< [bins]
};

struct OctreeStatistics {
    std::uint32_t format_version = 0;
    Grid grid;
    Vec3f bounds_min, bounds_max;  ///< m, relative to grid.origin
    std::uint64_t samples = 0, dropped = 0, leaves = 0, nodes = 0, lobes = 0, chunks = 0;
    std::uint64_t bytes = 0;  ///< of the file
    double bytes_per_leaf = 0.0;
    double total_area = 0.0;               ///< m²
    double mean_spacing = 0.0;             ///< m: area-weighted mean over the lobes
    std::vector<LevelStatistics> levels;   ///< [depth + 1]
    Histogram samples_per_leaf;            ///< powers of two: 0-1, 1-2, 2-4, ... samples
    Histogram ndf_length;                  ///< of leaves, 20 bins over 0..1
    Histogram opacity;                     ///< of leaves, 20 bins over 0..1
    std::vector<std::string> area_lights;  ///< names
    std::vector<std::string> scans;        ///< names of the stations
    std::string provenance;                ///< JSON
};

/// One pass over nodes and lobes; points are not read. `octree` must be sound (see check_octree) or
/// come from OctreeFile::open: indices are bounded either way. `file_bytes`: as OctreeFile::bytes.
OctreeStatistics measure_octree(const OctreeView& octree, std::uint64_t file_bytes);

}  // namespace glowworm

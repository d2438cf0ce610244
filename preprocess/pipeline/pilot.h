#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "octree/grid.h"
#include "octree/progress.h"
#include "preprocess/pipeline.h"
#include "preprocess/pipeline/octree_size.h"
#include "preprocess/read/scan_facts.h"

namespace glowworm {

/// What a conversion of some scans will come to, from doing a small part of it: all points are
/// looked at, a sample of each scan is registered where poses are not known, and some cells of the
/// cave, at full density, go through merging, normals and the octree.
struct Pilot {
    std::vector<ScanFacts> facts;  ///< of each scan
    std::uint64_t points = 0;      ///< of all scans
    double bytes_a_point = 0.0;    ///< of a point's columns
    std::size_t placed = 0;        ///< scans whose poses are known or were found
    std::size_t pairs = 0;         ///< of scans that registration will try
    Grid grid;                     ///< where the octree will go
    /// Its depth where the points' spacing is 5 % off: another one where it is decided narrowly.
    std::uint32_t least_depth = 0, most_depth = 0;
    OctreeSize octree;
    /// Processor seconds for a pair of scans, a surfel and a link; 0 where there was none to do.
    double pair_time = 0.0, surface_time = 0.0, link_time = 0.0;
    double surfel_bytes = 0.0;  ///< of a surfel in a PLY; 0 where none was made
};

/// Throws as open_scan_file and as the stages do.
Pilot run_pilot(std::span<const std::filesystem::path> files, const ConvertSettings& settings,
                const Progress& progress);

/// What a merged cloud's normals will take: up to 400 000 of its points go through `make_surfels`.
/// Throws as read_cloud and make_surfels do.
Pilot look_at_cloud(const std::filesystem::path& file, const ReadSettings& read,
                    const SurfaceSettings& surface, const Progress& progress);

/// The pairs that are expected to be tried among so many scans, one at least.
std::size_t expected_pairs(std::size_t scans);

}  // namespace glowworm

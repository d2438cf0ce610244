#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "preprocess/pipeline/octree_size.h"
#include "preprocess/pipeline/pilot.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// By how much a pilot's prediction may be too high.
inline constexpr double kPilotError = 0.25;

/// What there is to do: guessed from the files' headers, or told by a pilot.
struct Workload {
    std::size_t scans = 1;
    std::size_t pairs = 0;        ///< of scans to be tried
    std::uint64_t points = 0;     ///< of all scans
    double bytes_a_point = 16.0;  ///< of its columns
    OctreeSize octree;
    std::uint32_t links = 0;                                      ///< rays per lobe
    double pair_time = 0.0, surface_time = 0.0, link_time = 0.0;  ///< as Pilot's
    double surfel_bytes = 43.0;                                   ///< of one in a PLY
    double error = 0.0;  ///< 0.25: what is needed may be a quarter less than predicted
};

/// What it will take. The stages' costs per point, pair, surfel and leaf were measured on real and
/// simulated scans on the machine named in bench/README.md: memory as the peak of resident pages,
/// time as processor seconds.
struct Prediction {
    std::uint64_t read_memory = 0;     ///< bytes at the peak of reading, registering and merging
    std::uint64_t surface_memory = 0;  ///< of estimating normals
    std::uint64_t held_memory = 0;     ///< of what a conversion holds beside that
    std::uint64_t build_memory = 0;    ///< of building and linking
    std::uint64_t least_memory = 0;    ///< of the same, what cannot lie on disk
    std::uint64_t output_bytes = 0;    ///< the octree file
    std::uint64_t work_bytes = 0;      ///< what the stages keep until it is there
    double read_time = 0.0, register_time = 0.0, merge_time = 0.0, surface_time = 0.0,
           build_time = 0.0, link_time = 0.0;  ///< processor seconds
    Workload work;                             ///< what for

    std::uint64_t memory() const;   ///< bytes at the peak of all
    double processor_time() const;  ///< s, of all stages
};

Prediction predict(const Workload& work);

/// By the headers alone: within a factor of two, since nobody knows yet how much scans overlap.
/// For files that announce no number of points, what their size holds. Throws as open_scan_file.
Workload announced_work(std::span<const std::filesystem::path> files, const ReadSettings& settings);

/// By doing a part of it.
Workload piloted_work(const Pilot& pilot, std::uint32_t links);

/// Processor seconds as seconds on that many cores.
double wall_time(double processor_seconds, int threads);

}  // namespace glowworm

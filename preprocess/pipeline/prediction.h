#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "octree/build.h"
#include "preprocess/read/scan_facts.h"

namespace glowworm {

/// What is known before any work: from the files' headers alone, or from a look at their points.
struct Workload {
    std::size_t scans = 1;
    std::uint64_t points = 0;        ///< of all scans
    double spacing = 0.0;            ///< m, median distance to the nearest point; 0: not looked
    double extent = 0.0;             ///< m, longest side of what all scans span; 0: not looked
    std::optional<std::uint32_t> depth = {};
    std::optional<double> voxel_size = {};
    std::uint32_t links = 0;  ///< rays per lobe
};

/// What a conversion will take. The stages' costs per point, per pair of scans and per leaf were
/// measured on the bundled scans and on simulated ones, memory as the peak of resident pages, time
/// as processor seconds of one core of the machine named in bench/README.md; time is these over the
/// cores at work. How much scans overlap, and how even their points are, is not known before they
/// are registered: leaves, and with them links, are the uncertain part.
struct Prediction {
    std::uint32_t depth = 0;  ///< 0 where spacing and extent are not known
    double voxel_size = 0.0;  ///< m
    std::uint64_t surfels = 0, leaves = 0;
    std::uint64_t read_memory = 0;     ///< bytes at the peak of reading, registering and merging
    std::uint64_t surface_memory = 0;  ///< of estimating normals
    std::uint64_t build_memory = 0;    ///< of building and linking
    std::uint64_t output_bytes = 0;    ///< the octree file
    std::uint64_t work_bytes = 0;      ///< what the stages keep until it is there
    double seconds = 0.0;

    std::uint64_t memory() const;  ///< bytes at the peak of all
};

Prediction predict(const Workload& work, int threads);

/// How many points the headers of a file announce; for files that announce none, what its size
/// holds. Throws as open_scan_file.
std::uint64_t announced_points(const std::filesystem::path& file, const ReadSettings& settings,
                               std::size_t& scans);

/// The workload of files by their headers alone.
Workload announced_work(std::span<const std::filesystem::path> files, const ReadSettings& settings);

}  // namespace glowworm

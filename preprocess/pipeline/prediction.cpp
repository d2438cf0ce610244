#include "preprocess/pipeline/prediction.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

namespace glowworm {
namespace {

// Bytes.
constexpr double kProgram = 46e6;      // libraries, tables
constexpr double kNeeded = 20e6;       // of them while a limit is kept to, measured
constexpr double kSmallBlocks = 25e6;  // and pages to work in, measured
constexpr double kReadPoint = 75.0;    // a point of any scan until they are merged
constexpr double kSurfacePoint = 200.0;
constexpr double kHeldPoint = 40.0;
constexpr double kBuildSurfel = 100.0;
constexpr double kBuildLeaf = 300.0;
constexpr double kKeptSurfel = 83.0;  // in the cloud's and in the surfels' checkpoint

// Processor seconds.
constexpr double kReadTime = 2.3e-6;     // a point: read and clean
constexpr double kScanTime = 2.0e-6;     // a point of a scan's features
constexpr double kPairTime = 0.2;        // a pair of scans, tried and refined
constexpr double kMergeTime = 1.9e-6;    // a point
constexpr double kSurfaceTime = 2.6e-6;  // a surfel
constexpr double kBuildTime = 0.7e-6;    // a surfel
constexpr double kLeafTime = 1.5e-6;
constexpr double kLinkTime = 0.7e-6;  // where none was traced
constexpr double kParallel = 0.9;     // share of the cores that is at work

// Where only headers are known. n scans show less than n times what one shows: they overlap.
constexpr double kKeptShare = 0.87;  // of one scan's points; of n scans' times n^kKeptPower
constexpr double kKeptPower = -0.08;
constexpr double kLeafPower = -0.4;  // leaves per surfel of n scans
constexpr double kNodesPerLeaf = 1.35;
constexpr double kLobesPerLeaf = 1.2;
constexpr double kGuessError = 0.5;

/// How many points the headers of a file announce; where they announce none, what its size holds.
std::uint64_t announced_points(const std::filesystem::path& file, const ReadSettings& settings,
                               std::size_t& scans) {
    const std::unique_ptr<ScanFile> opened = open_scan_file(file, settings);
    ScanHeader header;
    if (!opened->next_scan(header)) return 0;
    const std::uint64_t bytes = std::filesystem::file_size(file);
    if (header.declared_points > 0) {
        // A count is believed as far as there are bytes for it.
        std::uint64_t points = 0;
        do {
            points += header.declared_points;
            ++scans;
        } while (opened->next_scan(header));
        return std::min(points, bytes);
    }
    ++scans;
    std::string start(65536, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(stream.gcount()));
    const auto lines = std::max<std::ptrdiff_t>(1, std::ranges::count(start, '\n'));
    return bytes * static_cast<std::uint64_t>(lines) / std::max<std::uint64_t>(1, start.size());
}

}  // namespace

std::uint64_t Prediction::memory() const {
    return std::max({read_memory, surface_memory + held_memory, build_memory});
}

double Prediction::processor_time() const {
    return read_time + register_time + merge_time + surface_time + build_time + link_time;
}

Prediction predict(const Workload& work) {
    const auto points = static_cast<double>(work.points);
    const OctreeSize& size = work.octree;
    const double links = size.lobes * work.links;
    const auto bytes = [](double value) { return static_cast<std::uint64_t>(value); };

    Prediction p;
    p.work = work;
    p.read_memory = bytes(kProgram + kReadPoint * points);
    p.surface_memory = bytes(kProgram + kSurfacePoint * size.surfels);
    p.held_memory = bytes(kHeldPoint * size.surfels);
    p.build_memory =
        bytes(kProgram + std::max(kBuildSurfel * size.surfels + kBuildLeaf * size.leaves,
                                  size.bytes(work.links)));
    p.least_memory = bytes(kNeeded + kSmallBlocks);
    p.output_bytes = bytes(size.bytes(work.links));
    p.work_bytes = bytes(work.bytes_a_point * points + kKeptSurfel * size.surfels + size.bytes(0));

    const auto known = [](double time, double guess) { return time > 0.0 ? time : guess; };
    p.read_time = kReadTime * points;
    if (work.scans > 1) {
        p.register_time =
            kScanTime * points + known(work.pair_time, kPairTime) * static_cast<double>(work.pairs);
    }
    p.merge_time = kMergeTime * points;
    p.surface_time = known(work.surface_time, kSurfaceTime) * size.surfels;
    p.build_time = kBuildTime * size.surfels + kLeafTime * size.leaves;
    p.link_time = known(work.link_time, kLinkTime) * links;
    return p;
}

Workload announced_work(std::span<const std::filesystem::path> files,
                        const ReadSettings& settings) {
    Workload work{.scans = 0};
    for (const std::filesystem::path& file : files) {
        const std::uint64_t points = announced_points(file, settings, work.scans);
        work.points += points;
    }
    work.scans = std::max<std::size_t>(work.scans, 1);
    const auto scans = static_cast<double>(work.scans);
    work.pairs = expected_pairs(work.scans);
    const double surfels =
        static_cast<double>(work.points) * kKeptShare * std::pow(scans, kKeptPower);
    const double leaves = surfels * std::pow(scans, kLeafPower);
    work.octree = {surfels, leaves, kNodesPerLeaf * leaves, kLobesPerLeaf * leaves};
    work.error = kGuessError;
    return work;
}

Workload piloted_work(const Pilot& pilot, std::uint32_t links) {
    Workload work{.scans = std::max<std::size_t>(pilot.facts.size(), 1),
                  .pairs = pilot.pairs,
                  .points = pilot.points,
                  .bytes_a_point = pilot.bytes_a_point,
                  .octree = pilot.octree,
                  .links = links,
                  .pair_time = pilot.pair_time,
                  .surface_time = pilot.surface_time,
                  .link_time = pilot.link_time,
                  .error = kPilotError};
    if (pilot.surfel_bytes > 0.0) work.surfel_bytes = pilot.surfel_bytes;
    return work;
}

double wall_time(double processor_seconds, int threads) {
    return processor_seconds / (kParallel * std::max(threads, 1));
}

}  // namespace glowworm

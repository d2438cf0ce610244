#include "preprocess/pipeline/prediction.h"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace glowworm {
namespace {

// Bytes.
constexpr double kProgram = 42e6;    // libraries, tables
constexpr double kReadPoint = 75.0;  // a point of any scan until they are merged
constexpr double kSurfacePoint = 200.0;
constexpr double kBuildSurfel = 70.0;
constexpr double kBuildLeaf = 560.0;
constexpr double kLinkedLeaf = 160.0;  // the octree itself while its links are traced
constexpr double kLink = 4.0;
constexpr double kFileSurfel = 20.0;
constexpr double kFileLeaf = 118.0;
constexpr double kKeptPoint = 15.0;   // a point in a scan's checkpoint
constexpr double kKeptSurfel = 83.0;  // a point in the cloud's and in the surfels' checkpoint

// Processor seconds.
constexpr double kReadTime = 2.2e-6;     // a point: read and clean
constexpr double kScanTime = 0.2;        // a scan's features
constexpr double kPairTime = 0.15;       // a pair of scans, tried and refined
constexpr double kMergeTime = 1.5e-6;    // a point
constexpr double kSurfaceTime = 2.1e-6;  // a point
constexpr double kLeafTime = 5e-6;
constexpr double kLinkTime = 1.35e-6;
constexpr double kParallel = 0.9;  // share of the cores that is at work

// Shares and ratios. n scans show less than n times what one shows, since they overlap.
constexpr double kKeptShare = 0.87;  // of one scan's points; of n scans' times n^kKeptPower
constexpr double kKeptPower = -0.08;
constexpr double kSpacingOfNearest = 2.1;  // spacing of surfels over distance to the nearest
constexpr double kUneven = 2.9;            // mean area of one scan's surfels over the median one's
constexpr double kAreaPower = 0.25;        // n scans have n^kAreaPower times the area of one
constexpr double kLeavesPerFace = 1.4;
constexpr double kLeavesPower = -0.4;  // leaves per surfel of n scans, spacing unknown
constexpr std::size_t kPairsPerScan = 8;
constexpr double kSamplesPerFace = 3.5;
constexpr std::uint32_t kDeepest = 11;

void predict_depth(const Workload& work, Prediction& p) {
    const double edge = work.extent * 33.0 / 32.0;
    const double spacing = kSpacingOfNearest * work.spacing;
    if (work.voxel_size) {
        p.voxel_size = *work.voxel_size;
        p.depth = static_cast<std::uint32_t>(
            std::max(0.0, std::ceil(std::log2(std::max(edge / p.voxel_size, 1.0)))));
        return;
    }
    p.depth = work.depth.value_or(1);
    while (!work.depth && p.depth < kDeepest &&
           edge / (2u << p.depth) >= spacing * std::sqrt(kSamplesPerFace))
        ++p.depth;
    p.voxel_size = std::ldexp(edge, -static_cast<int>(p.depth));
}

}  // namespace

std::uint64_t Prediction::memory() const {
    return std::max({read_memory, surface_memory, build_memory});
}

Prediction predict(const Workload& work, int threads) {
    Prediction p;
    const double points = static_cast<double>(work.points);
    const double scans = static_cast<double>(work.scans);
    const double surfels = points * kKeptShare * std::pow(scans, kKeptPower);
    double leaves = surfels * std::pow(scans, kLeavesPower);
    if (work.spacing > 0.0 && work.extent > 0.0) {
        predict_depth(work, p);
        const double spacing = kSpacingOfNearest * work.spacing;
        const double area =
            points / scans * kKeptShare * kUneven * spacing * spacing * std::pow(scans, kAreaPower);
        leaves = kLeavesPerFace * area / (p.voxel_size * p.voxel_size);
    }
    const double links = leaves * work.links;
    const double pairs =
        0.5 * static_cast<double>(work.scans * std::min(work.scans - 1, kPairsPerScan));
    p.surfels = static_cast<std::uint64_t>(surfels);
    p.leaves = static_cast<std::uint64_t>(leaves);

    const auto bytes = [](double value) { return static_cast<std::uint64_t>(value); };
    p.read_memory = bytes(kProgram + kReadPoint * points);
    p.surface_memory = bytes(kProgram + kSurfacePoint * surfels);
    p.build_memory = bytes(kProgram + std::max(kBuildSurfel * surfels + kBuildLeaf * leaves,
                                               kLinkedLeaf * leaves + kLink * links));
    const double octree = kFileSurfel * surfels + kFileLeaf * leaves;
    p.output_bytes = bytes(octree + kLink * links);
    p.work_bytes = bytes(kKeptPoint * points + kKeptSurfel * surfels + octree);

    const double seconds = points * (kReadTime + kMergeTime) + surfels * kSurfaceTime +
                           scans * kScanTime + pairs * kPairTime + leaves * kLeafTime +
                           links * kLinkTime;
    p.seconds = seconds / (kParallel * std::max(threads, 1));
    return p;
}

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

Workload announced_work(std::span<const std::filesystem::path> files,
                        const ReadSettings& settings) {
    Workload work{.scans = 0};
    for (const std::filesystem::path& file : files) {
        const std::uint64_t points = announced_points(file, settings, work.scans);
        work.points += points;
    }
    work.scans = std::max<std::size_t>(work.scans, 1);
    return work;
}

}  // namespace glowworm

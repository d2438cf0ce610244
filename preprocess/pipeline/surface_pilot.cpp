#include <algorithm>
#include <numeric>

#include "preprocess/pipeline/column_bytes.h"
#include "preprocess/pipeline/listening.h"
#include "preprocess/pipeline/look.h"
#include "preprocess/pipeline/pilot.h"
#include "preprocess/pipeline/processor_time.h"
#include "preprocess/surface/surfel_points.h"

namespace glowworm {
namespace {

constexpr std::size_t kPilotCloud = 400'000;  // points of a merged cloud
constexpr double kWriteTime = 0.15e-6;        // s, a surfel into a PLY

/// What came of a part of a cloud.
struct SurfaceTrial {
    std::size_t points = 0, surfels = 0;
    double seconds = 0.0, surfel_bytes = 0.0;
};

/// The normals of the `count` points nearest to the one in the middle of the file, as dense as all.
SurfaceTrial try_surface(const PointCloud& cloud, std::size_t count,
                         const SurfaceSettings& settings, const Progress& progress) {
    const std::vector<Vec3f>& positions = cloud.points.positions;
    std::vector<std::uint32_t> part(positions.size());
    std::iota(part.begin(), part.end(), 0u);
    if (count < part.size()) {
        const Vec3f middle = positions[positions.size() / 2];
        const auto nearer = [&](std::uint32_t i, std::uint32_t j) {
            const Vec3f a = positions[i] - middle, b = positions[j] - middle;
            return dot(a, a) < dot(b, b);
        };
        std::ranges::nth_element(part, part.begin() + std::ptrdiff_t(count), nearer);
        part.resize(count);
        std::ranges::sort(part);
    }
    const PointCloud some{cloud.origin, cloud.points.select(part), cloud.stations, {}};
    const double start = processor_time();
    const SurfelCloud surfels = make_surfels(some, settings, nullptr, progress);
    const double seconds = processor_time() - start;
    // A PLY has the error of the normal beside a surfel's columns.
    const double bytes = bytes_of(to_points(surfels).points) + sizeof(float);
    return {part.size(), surfels.surfels.size(), seconds, bytes};
}

}  // namespace

Pilot look_at_cloud(const std::filesystem::path& file, const ReadSettings& read,
                    const SurfaceSettings& surface, const Progress& progress_out) {
    Listening listening(progress_out);
    const Progress progress = listening.shown(), heard = listening.heard();

    // 1. Facts, for the warnings.
    Pilot pilot;
    std::vector<LookedScan> scans = look_at(std::span(&file, 1), read, progress);
    const auto none = [](auto, const auto&) { return false; };
    pick_points(std::span(&file, 1), read, scans, none, progress);
    for (const LookedScan& scan : scans)
        pilot.facts.push_back(scan.facts);

    // 2. Two parts of it, since time grows with the points from what a cloud of any size takes.
    const double start = processor_time();
    const PointCloud cloud = read_cloud(file, read, nullptr, heard);
    const double read_time = processor_time() - start;
    pilot.points = cloud.points.size();
    const SurfaceTrial large = try_surface(cloud, kPilotCloud, surface, heard);
    double seconds = large.seconds;
    if (large.points < pilot.points) {
        const SurfaceTrial small = try_surface(cloud, kPilotCloud / 4, surface, heard);
        const double each = (large.seconds - small.seconds) / double(large.points - small.points);
        seconds += std::max(each, 0.0) * double(pilot.points - large.points);
    }
    pilot.octree.surfels = double(pilot.points) * double(large.surfels) / double(large.points);
    pilot.surface_time = (read_time + seconds) / pilot.octree.surfels + kWriteTime;
    pilot.surfel_bytes = large.surfel_bytes;
    return pilot;
}

}  // namespace glowworm

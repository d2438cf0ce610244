#include "preprocess/pipeline/pilot.h"

#include <algorithm>
#include <cmath>

#include "octree/cloud_summary.h"
#include "octree/error.h"
#include "octree/links.h"
#include "octree/octree.h"
#include "preprocess/kd_tree.h"
#include "preprocess/pipeline/cell_sample.h"
#include "preprocess/pipeline/column_bytes.h"
#include "preprocess/pipeline/listening.h"
#include "preprocess/pipeline/look.h"
#include "preprocess/pipeline/pilot_places.h"
#include "preprocess/pipeline/processor_time.h"

namespace glowworm {
namespace {

constexpr double kPilotPoints = 80'000.0;         // that go through all stages
constexpr std::size_t kMiniaturePoints = 60'000;  // of the whole, thinned, for its light
constexpr double kMargin = 8.0;                   // round a cell, in spacings of one scan
constexpr double kSpacingError = 0.05;            // of the median surfel's radius
constexpr std::uint32_t kPilotRays = 8;

/// Bounds of all scans, and the spacing that says how deep the octree becomes.
CloudSummary summary_of(const PlaceBounds& box, double times_longer, const Vec3d& origin,
                        double radius) {
    const Vec3d middle = (box.low + box.high) * 0.5, half = (box.high - box.low) * 0.5;
    CloudSummary summary;
    summary.bounds_min = vec3_cast<float>(middle - half * times_longer - origin);
    summary.bounds_max = vec3_cast<float>(middle + half * times_longer - origin);
    summary.usable = 1;
    summary.median_radius = radius;
    return summary;
}

/// Median distance to the nearest point that all points of a scan have, by that of its sample.
double expected_spacing(const LookedScan& scan) {
    const std::vector<Vec3f>& positions = scan.sample.points.positions;
    const KdTree tree(positions);
    std::vector<float> squared;
    for (std::size_t i = 0; i < positions.size(); i += 16) {
        Neighbour found[2];
        if (tree.nearest(positions[i], found) == 2) squared.push_back(found[1].squared_distance);
    }
    if (squared.empty()) return 0.0;
    const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
    std::nth_element(squared.begin(), middle, squared.end());
    return std::sqrt(double(*middle) * double(positions.size()) / double(scan.facts.counts.kept));
}

/// The surfels of the chosen cells and of a margin round them, relative to the grid's origin. What
/// one of them takes is kept in `pilot`.
SurfelCloud make_pilot_surfels(std::span<const Scan> picked, const Poses& poses,
                               const ConvertSettings& settings, const Vec3d& origin,
                               const Progress& progress, Pilot& pilot) {
    std::vector<Scan> scans;
    for (const Scan& scan : picked) {
        scans.push_back(scan);
        scans.back().points = clean(scan.points, scan.has_viewpoint, settings.clean);
    }
    MergeSettings merge = settings.merge;
    merge.remove_moving = false;
    const PointCloud cloud = merge_scans(scans, poses, merge, progress);
    const double start = processor_time();
    SurfelCloud surfels = make_surfels(cloud, settings.surface, nullptr, progress);
    pilot.surface_time = (processor_time() - start) /
                         static_cast<double>(std::max<std::size_t>(cloud.points.size(), 1));
    const Vec3f shift = vec3_cast<float>(surfels.origin - origin);
    for (Surfel& surfel : surfels.surfels)
        surfel.position = surfel.position + shift;
    surfels.origin = origin;
    return surfels;
}

double median_radius_inside(const SurfelCloud& cloud, const CellSample& cells) {
    std::vector<float> radii;
    for (const Surfel& surfel : cloud.surfels) {
        if (cells.holds(vec3_cast<double>(surfel.position))) radii.push_back(surfel.radius);
    }
    if (radii.empty()) return 0.0;
    const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    return *middle;
}

/// What a link takes, traced in an octree of the whole made of few of its points.
double time_links(std::span<const LookedScan> scans, const Poses& poses,
                  const ConvertSettings& settings, const Progress& progress) {
    std::vector<Scan> samples;
    std::size_t points = 0;
    for (const LookedScan& scan : scans)
        points += scan.sample.points.size();
    const std::size_t step = points / kMiniaturePoints + 1;
    for (const LookedScan& scan : scans) {
        Scan& sample = samples.emplace_back(scan.sample);
        std::vector<Vec3f>& positions = sample.points.positions;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < positions.size(); i += step)
            positions[kept++] = positions[i];
        positions.resize(kept);
    }
    MergeSettings merge;
    merge.remove_moving = merge.thin_overlaps = false;
    const SurfelCloud cloud = make_surfels(merge_scans(samples, poses, merge, progress),
                                           settings.surface, nullptr, progress);
    const Octree octree = build_octree(cloud, {}, progress);
    const double start = processor_time();
    const auto links = trace_links(octree.view(), {.rays = kPilotRays}, progress);
    return (processor_time() - start) / static_cast<double>(std::max<std::size_t>(links.size(), 1));
}

}  // namespace

Pilot run_pilot(std::span<const std::filesystem::path> files, const ConvertSettings& settings,
                const Progress& progress_out) {
    Listening listening(progress_out);
    const Progress progress = listening.shown(), heard = listening.heard();

    // 1. A look at all points.
    Pilot pilot;
    std::vector<LookedScan> scans = look_at(files, settings.read, progress);
    for (const LookedScan& scan : scans)
        pilot.points += scan.facts.counts.kept;
    const auto finish = [&] {
        for (const LookedScan& scan : scans)
            pilot.facts.push_back(scan.facts);
        return pilot;
    };
    if (scans.empty()) return finish();

    // 2. Where the scans lie, and how far all of them will reach.
    const Poses poses = find_poses(scans, settings.registration, heard, pilot);
    const std::vector<std::vector<WeightedPlace>> places = places_of(scans, poses);
    pilot.placed = places.size();
    if (places.empty()) {
        pick_points(
            files, settings.read, scans, [](auto, const auto&) { return false; }, progress);
        return finish();
    }
    const auto first_half = std::span(places).first((places.size() + 1) / 2);
    const PlaceBounds box = box_of(places);
    const Vec3d origin = poses.origin + (box.low + box.high) * 0.5;
    const double longer =
        grown(box_of(first_half).longest(), box.longest(), places.size(), scans.size()) /
        std::max(box.longest(), 1e-9);
    std::vector<WeightedPlace> together;
    std::size_t half_count = 0;
    for (const std::vector<WeightedPlace>& of_scan : places) {
        for (const WeightedPlace& place : of_scan)
            together.push_back({place.position + poses.origin - origin, place.points});
        if (&of_scan == &first_half.back()) half_count = together.size();
    }

    // 3. Some cells at full density through merging and normals, which decides the depth.
    BuildSettings build = settings.build;
    const Vec3d relative = origin - poses.origin;
    pilot.grid = fit_grid(summary_of(box, longer, relative, 1.0), origin, build);
    const CellSample cells(pilot.grid, together, kPilotPoints);
    std::vector<const Eigen::Isometry3d*> T_world_scan;
    for (const LookedScan& scan : scans) {
        const ScanPose* pose = find_pose(poses, scan.sample);
        const bool is_placed = pose != nullptr && pose->status != PoseStatus::kUnregistered;
        T_world_scan.push_back(is_placed ? &pose->T_world_scan : nullptr);
    }
    std::vector<double> margins;
    for (const LookedScan& scan : scans)
        margins.push_back(std::min(kMargin * expected_spacing(scan), cells.edge()));
    const auto wanted = [&](std::size_t scan, const Vec3d& p) {
        if (T_world_scan[scan] == nullptr) return false;
        return cells.is_near(transformed(*T_world_scan[scan], p) - relative, margins[scan]);
    };
    const std::vector<Scan> picked = pick_points(files, settings.read, scans, wanted, progress);
    for (const Scan& scan : picked)
        pilot.bytes_a_point = std::max(pilot.bytes_a_point, bytes_of(scan.points));
    const SurfelCloud surfels = make_pilot_surfels(picked, poses, settings, origin, heard, pilot);
    // Where these cells are all, their surfels are those of the conversion, strays gone.
    const bool is_whole = cells.level() == 0 && places.size() == scans.size();
    const CloudSummary summary =
        is_whole ? summarize(surfels.surfels)
                 : summary_of(box, longer, relative, median_radius_inside(surfels, cells));
    const auto grid_for = [&](double times_wider) {
        CloudSummary other = summary;
        other.median_radius *= times_wider;
        return fit_grid(other, origin, build);
    };
    pilot.grid = grid_for(1.0);
    pilot.least_depth = grid_for(1.0 + kSpacingError).depth;
    pilot.most_depth = grid_for(1.0 - kSpacingError).depth;

    // 4. The octree of these cells, and what stands for all.
    pilot.octree = size_by_cells(surfels, cells, together, pilot.grid);
    const auto occupied = [&](std::size_t count) {
        return static_cast<double>(
            occupied_cells(pilot.grid, std::span(together).first(count), cells.level()));
    };
    const double now = occupied(together.size());
    const double more = grown(occupied(half_count), now, places.size(), scans.size()) / now;
    const double surfels_placed = pilot.octree.surfels;
    pilot.octree = pilot.octree.times(more);
    // Where scans that were not placed show the same places again, the points there become more.
    double points_placed = 0.0;
    for (const WeightedPlace& place : together)
        points_placed += place.points;
    pilot.octree.surfels = surfels_placed * static_cast<double>(pilot.points) / points_placed;
    if (settings.links > 0) pilot.link_time = time_links(scans, poses, settings, heard);
    return finish();
}

std::size_t expected_pairs(std::size_t scans) {
    constexpr std::size_t kPairsPerScan = 8;
    return scans * std::min(scans - 1, kPairsPerScan) / 2;
}

}  // namespace glowworm

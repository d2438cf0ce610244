#include "preprocess/merge.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "octree/error.h"
#include "preprocess/kd_tree.h"
#include "preprocess/moving.h"

namespace glowworm {
namespace {

constexpr double kNearOrigin = 1000.0;  // m: floats hold 0.1 mm up to here

/// A scan and its pose, positions on their way into the result's frame.
struct PlacedScan {
    const Scan* scan;
    Eigen::Isometry3d T_cloud_scan;  ///< maps the scan's positions to the cloud's
};

Eigen::Vector3d to_eigen(const Vec3d& v) {
    return {v.x, v.y, v.z};
}
Vec3d to_vec3(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

/// The middle of the stations in whole metres where they are far from the poses' origin.
Vec3d cloud_origin(const Poses& poses, std::span<const Eigen::Vector3d> centres) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& centre : centres)
        sum += centre;
    const Eigen::Vector3d middle = sum / static_cast<double>(centres.size());
    if (middle.norm() <= kNearOrigin) return poses.origin;
    return poses.origin +
           Vec3d{std::round(middle.x()), std::round(middle.y()), std::round(middle.z())};
}

/// The scan's first finite position, which stands for where the scan is.
Eigen::Vector3d some_place(const Scan& scan) {
    for (const Vec3f& p : scan.points.positions) {
        if (is_finite(p)) return to_eigen(scan.offset + vec3_cast<double>(p));
    }
    return Eigen::Vector3d::Zero();
}

/// Median distance to the nearest neighbour over an even sample of all scans' points, m.
double median_spacing(std::span<const PlacedScan> placed) {
    std::vector<float> spacings;
    for (const PlacedScan& p : placed) {
        const std::vector<Vec3f>& positions = p.scan->points.positions;
        const KdTree tree(positions);
        const std::size_t step = std::max<std::size_t>(1, positions.size() / 2000);
        for (std::size_t i = 0; i < positions.size(); i += step) {
            Neighbour found[2];
            if (tree.nearest(positions[i], found) == 2 && found[1].squared_distance > 0.0f) {
                spacings.push_back(std::sqrt(found[1].squared_distance));
            }
        }
    }
    if (spacings.empty()) return 0.0;
    const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
    std::nth_element(spacings.begin(), middle, spacings.end());
    return static_cast<double>(*middle);
}

/// Scan `index` in the cloud's frame, every point with its station.
Points transform(const PlacedScan& placed, std::uint32_t station) {
    Points moved = placed.scan->points;
    const Eigen::Matrix3d R = placed.T_cloud_scan.rotation();
    tbb::parallel_for(std::size_t{0}, moved.size(), [&](std::size_t i) {
        const Eigen::Vector3d p = to_eigen(vec3_cast<double>(moved.positions[i]));
        moved.positions[i] = vec3_cast<float>(to_vec3(placed.T_cloud_scan * p));
        if (!moved.normals.empty()) {
            const Eigen::Vector3d n = R * to_eigen(vec3_cast<double>(moved.normals[i]));
            moved.normals[i] = vec3_cast<float>(to_vec3(n));
        }
    });
    moved.stations.assign(moved.size(), station);
    return moved;
}

/// What a sample costs: its range, so that the nearer station wins (its spot is smaller and its
/// angular noise shorter), over the cosine of incidence where a normal tells it.
float sample_cost(const Points& points, std::uint32_t i, const Vec3f& station) {
    const Vec3f ray = station - points.positions[i];
    const float range = length(ray);
    if (points.normals.empty() || range <= 0.0f) return range;
    return range / std::max(std::abs(dot(points.normals[i], ray)) / range, 0.1f);
}

struct CellSample {
    std::uint64_t cell;
    float cost;
    std::uint32_t index;
    bool operator<(const CellSample& o) const {
        if (cell != o.cell) return cell < o.cell;
        return cost != o.cost ? cost < o.cost : index < o.index;
    }
};

/// Indices, ascending, of the cheapest sample of each cell of edge `spacing`.
std::vector<std::uint32_t> cheapest_per_cell(const Points& points, double spacing,
                                             std::span<const Vec3f> stations) {
    Vec3f low = points.positions.front(), high = low;
    for (const Vec3f& p : points.positions) {
        low = component_min(low, p);
        high = component_max(high, p);
    }
    const Vec3f extent = high - low;
    const double longest = static_cast<double>(std::max({extent.x, extent.y, extent.z}));
    if (longest / spacing >= 2097151.0) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("a spacing of {} m is too fine to merge {} m of scans; use at least "
                        "{:.6f} m",
                        spacing, longest, longest / 2097151.0));
    }
    std::vector<CellSample> samples(points.size());
    tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(points.size()),
                      [&](std::uint32_t i) {
                          const Vec3d d = vec3_cast<double>(points.positions[i] - low) / spacing;
                          samples[i] = {static_cast<std::uint64_t>(d.z) << 42 |
                                            static_cast<std::uint64_t>(d.y) << 21 |
                                            static_cast<std::uint64_t>(d.x),
                                        sample_cost(points, i, stations[points.stations[i]]), i};
                      });
    tbb::parallel_sort(samples.begin(), samples.end());
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (i == 0 || samples[i].cell != samples[i - 1].cell) kept.push_back(samples[i].index);
    }
    std::sort(kept.begin(), kept.end());
    return kept;
}

}  // namespace

PointCloud merge_scans(std::span<const Scan> scans, const Poses& poses,
                       const MergeSettings& settings, const Progress& progress,
                       MergeReport* report) {
    MergeReport counted;
    PointCloud cloud;

    // 1. Who takes part, and where the cloud's origin lies.
    std::vector<PlacedScan> placed;
    std::vector<Eigen::Vector3d> centres;
    for (const Scan& scan : scans) {
        const ScanPose* pose = find_pose(poses, scan);
        if (pose == nullptr || pose->status == PoseStatus::kUnregistered || scan.points.empty()) {
            counted.left_out.push_back(pose_file(scan));
            continue;
        }
        counted.points_in += scan.points.size();
        placed.push_back({&scan, pose->T_world_scan});
        centres.push_back(pose->T_world_scan * some_place(scan));
    }
    if (placed.empty()) {
        throw Error(ExitCode::kDegenerate,
                    "none of the scans has a pose and points, so there is nothing to merge; "
                    "register them first or give a poses.json that names them");
    }
    cloud.origin = cloud_origin(poses, centres);
    const Eigen::Vector3d shift = to_eigen(poses.origin - cloud.origin);
    std::vector<Vec3f> station_places;
    for (PlacedScan& p : placed) {
        const Eigen::Isometry3d T_world_scan = p.T_cloud_scan;
        const Eigen::Quaterniond q(T_world_scan.rotation());
        const Eigen::Vector3d place = T_world_scan.translation() + shift;
        station_places.push_back(vec3_cast<float>(to_vec3(place)));
        cloud.stations.push_back({.position = cloud.origin + to_vec3(place),
                                  .rotation = {q.x(), q.y(), q.z(), q.w()},
                                  .has_viewpoint = p.scan->has_viewpoint,
                                  .name = p.scan->name});
        p.T_cloud_scan = Eigen::Translation3d(shift) * T_world_scan *
                         Eigen::Translation3d(to_eigen(p.scan->offset));
    }

    // 2. Moving things out, the rest into the cloud's frame.
    std::vector<PlacedView> views;
    for (const PlacedScan& p : placed)
        views.push_back({p.scan, p.T_cloud_scan});
    const std::vector<std::vector<std::uint32_t>> standing =
        settings.remove_moving ? standing_points(views) : std::vector<std::vector<std::uint32_t>>{};
    for (std::uint32_t s = 0; s < placed.size(); ++s) {
        Points moved = transform(placed[s], s);
        if (!standing.empty()) {
            counted.moving += moved.size() - standing[s].size();
            moved = moved.select(standing[s]);
        }
        cloud.points.append(moved);
        if (progress) progress(s + 1, placed.size() + 1);
    }

    // 3. Even spacing, the better sample of each place.
    counted.spacing = settings.spacing > 0.0 ? settings.spacing : median_spacing(placed);
    if (settings.thin_overlaps && counted.spacing > 0.0 && !cloud.points.empty()) {
        const std::size_t before = cloud.points.size();
        cloud.points =
            cloud.points.select(cheapest_per_cell(cloud.points, counted.spacing, station_places));
        counted.thinned = before - cloud.points.size();
    }
    if (cloud.points.empty()) {
        throw Error(ExitCode::kDegenerate, "no point is left after merging; check the scans");
    }
    if (progress) progress(placed.size() + 1, placed.size() + 1);
    if (report != nullptr) *report = counted;
    return cloud;
}

}  // namespace glowworm

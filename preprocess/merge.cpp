#include "preprocess/merge.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "octree/error.h"
#include "preprocess/better_sample.h"
#include "preprocess/colour_balance.h"
#include "preprocess/kd_tree.h"
#include "preprocess/moving.h"

namespace glowworm {
namespace {

constexpr double kNearOrigin = 1000.0;     // m: floats hold 0.1 mm up to here
constexpr double kColourCell = 4.0;        // in spacings
constexpr double kLeastColourCell = 0.05;  // m

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
    std::vector<std::uint8_t> has_viewpoint;
    for (PlacedScan& p : placed) {
        const Eigen::Isometry3d T_world_scan = p.T_cloud_scan;
        const Eigen::Quaterniond q(T_world_scan.rotation());
        const Eigen::Vector3d place = T_world_scan.translation() + shift;
        has_viewpoint.push_back(p.scan->has_viewpoint);
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

    // 3. Colours that agree, then even spacing with the better sample of each place.
    counted.spacing = settings.spacing > 0.0 ? settings.spacing : median_spacing(placed);
    if (settings.balance_colour && !cloud.points.empty()) {
        const double cell = std::max(kColourCell * counted.spacing, kLeastColourCell);
        apply_gains(cloud.points, colour_gains(cloud.points, placed.size(), cell));
    }
    if (settings.thin_overlaps && counted.spacing > 0.0) {
        const std::size_t before = cloud.points.size();
        cloud.points = cloud.points.select(
            best_samples(cloud.points, counted.spacing, station_places, has_viewpoint));
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

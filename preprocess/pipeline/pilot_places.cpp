#include "preprocess/pipeline/pilot_places.h"

#include <algorithm>
#include <optional>

#include "preprocess/pipeline/processor_time.h"

namespace glowworm {
namespace {

/// Poses that are given for all scans; nothing where one has none, or none is to be used.
std::optional<Poses> given_poses(std::span<const LookedScan> scans,
                                 const RegistrationSettings& settings) {
    if (settings.mode == PriorMode::kIgnore && scans.size() > 1) return {};
    Poses poses;
    if (settings.prior) poses.origin = settings.prior->origin;
    for (const LookedScan& scan : scans) {
        const ScanPose* given = settings.prior ? find_pose(*settings.prior, scan.sample) : nullptr;
        ScanPose& pose = poses.scans.emplace_back();
        pose.file = pose_file(scan.sample);
        pose.status = PoseStatus::kPrior;
        if (given != nullptr) {
            pose.T_world_scan = given->T_world_scan;
        } else if (scan.sample.T_world_scan) {
            pose.T_world_scan = *scan.sample.T_world_scan;
        } else if (scans.size() > 1) {
            return {};
        }
    }
    return poses;
}

}  // namespace

Vec3d transformed(const Eigen::Isometry3d& T, const Vec3d& p) {
    const Eigen::Vector3d moved = T * Eigen::Vector3d(p.x, p.y, p.z);
    return {moved.x(), moved.y(), moved.z()};
}

Poses find_poses(std::span<const LookedScan> scans, const RegistrationSettings& settings,
                 const Progress& progress, Pilot& pilot) {
    const std::size_t all = scans.size();
    pilot.pairs = expected_pairs(all);
    if (const std::optional<Poses> given = given_poses(scans, settings)) return *given;
    std::vector<Scan> samples;
    for (const LookedScan& scan : scans.first(std::min(all, kMostPiloted)))
        samples.push_back(scan.sample);
    const double start = processor_time();
    const Registration found = align_scans(samples, settings, progress);
    const std::size_t tried = std::max<std::size_t>(found.pairs_tried, 1);
    pilot.pairs = tried * all / samples.size();
    pilot.pair_time = (processor_time() - start) / static_cast<double>(tried);
    return found.poses;
}

std::vector<std::vector<WeightedPlace>> places_of(std::span<const LookedScan> scans,
                                                  const Poses& poses) {
    std::vector<std::vector<WeightedPlace>> places;
    for (const LookedScan& scan : scans) {
        const ScanPose* pose = find_pose(poses, scan.sample);
        if (pose == nullptr || pose->status == PoseStatus::kUnregistered) continue;
        const std::vector<Vec3f>& positions = scan.sample.points.positions;
        if (positions.empty()) continue;  // all points of the scan were one and the same
        std::vector<WeightedPlace>& own = places.emplace_back();
        const double weight = double(scan.facts.counts.kept) / double(positions.size());
        for (const Vec3f& p : positions) {
            const Vec3d in_frame = scan.sample.offset + vec3_cast<double>(p);
            own.push_back({transformed(pose->T_world_scan, in_frame), weight});
        }
    }
    return places;
}

PlaceBounds box_of(std::span<const std::vector<WeightedPlace>> places) {
    PlaceBounds box{places.front().front().position, places.front().front().position};
    for (const std::vector<WeightedPlace>& of_scan : places) {
        for (const WeightedPlace& place : of_scan) {
            box.low = component_min(box.low, place.position);
            box.high = component_max(box.high, place.position);
        }
    }
    return box;
}

double grown(double half, double now, std::size_t placed, std::size_t all) {
    if (placed >= all || placed < 2)
        return now * double(all) / double(std::max<std::size_t>(placed, 1));
    const double per_scan = (now - half) / double(placed - placed / 2);
    return now + per_scan * double(all - placed);
}

}  // namespace glowworm

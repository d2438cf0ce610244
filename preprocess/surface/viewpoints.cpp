#include "preprocess/surface/viewpoints.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "preprocess/kd_tree.h"
#include "preprocess/surface/disc_cast.h"

namespace glowworm {
namespace {

/// Poses closer than this see the same, m.
constexpr double kPoseSpacing = 0.25;

/// A point is asked about the nearest poses only.
constexpr std::size_t kNearestPoses = 8;

/// A point's time may lie this far outside the trajectory, s.
constexpr double kLate = 1.0;

/// The viewpoint of a point that none is known for.
constexpr std::uint32_t kUnseen = std::numeric_limits<std::uint32_t>::max();

/// A view flatter than this (cosine) says nothing about the side.
constexpr float kFlat = 0.05f;

/// Points asked whether they see a place, the share that must, and the least median distance, m.
/// From behind its walls a closed space shows half of itself at most.
constexpr std::size_t kWitnesses = 4096;
constexpr double kAllSee = 0.8;
constexpr float kScannerSize = 0.4f;

/// Appends the poses to the viewpoints; returns the place of the first.
std::uint32_t append_poses(const Trajectory& poses, const Vec3d& origin, SurfacePoints& points) {
    const auto first = static_cast<std::uint32_t>(points.viewpoints.size());
    if (points.seen_from.empty()) {
        // A station that the cloud does not name must not become one of the poses.
        std::vector<std::uint32_t> seen_from(points.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            seen_from[i] = points.is_viewed(i) ? points.station(i) : kUnseen;
        points.seen_from = std::move(seen_from);
    }
    for (const Vec3d& position : poses.positions)
        points.viewpoints.push_back(vec3_cast<float>(position - origin));
    points.has_viewpoint.resize(points.viewpoints.size(), true);
    return first;
}

bool sees(const SurfacePoints& points, const std::vector<LocalPlane>& planes, const DiscCast& cast,
          std::size_t i, const Vec3f& viewpoint) {
    const LocalPlane& plane = planes[i];
    if (!(plane.area > 0.0f)) return false;
    const Vec3f from = points.tree.position(i) + plane.normal * plane.height;
    const Vec3f view = viewpoint - from;
    const float distance = length(view);
    if (!(distance > 0.0f)) return false;
    const Vec3f direction = view / distance;
    const float cosine = std::abs(dot(plane.normal, direction));
    if (cosine < kFlat) return false;
    return cast.first(from, direction, cast.clearance(i, cosine), distance).point == kNoNeighbour;
}

}  // namespace

std::size_t view_by_time(const Trajectory& trajectory, const Vec3d& origin,
                         std::span<const double> times, SurfacePoints& points) {
    const Trajectory poses = thin_trajectory(trajectory, kPoseSpacing);
    const double begin = trajectory.times.front() - kLate, end = trajectory.times.back() + kLate;
    const std::uint32_t first = append_poses(poses, origin, points);
    std::size_t viewed = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double time = times[points.tree.order[i]];
        if (points.is_viewed(i) || !(time >= begin && time <= end)) continue;
        auto after = std::ranges::lower_bound(poses.times, time);
        if (after == poses.times.end() ||
            (after != poses.times.begin() && time - after[-1] < *after - time)) {
            --after;
        }
        points.seen_from[i] = first + static_cast<std::uint32_t>(after - poses.times.begin());
        ++viewed;
    }
    return viewed;
}

std::size_t view_by_sight(const Trajectory& trajectory, const Vec3d& origin,
                          const std::vector<LocalPlane>& planes, SurfacePoints& points) {
    const Trajectory poses = thin_trajectory(trajectory, kPoseSpacing);
    const std::uint32_t first = append_poses(poses, origin, points);
    const KdTree tree(std::span(points.viewpoints).subspan(first));
    const DiscCast cast(points, planes);
    std::vector<std::uint32_t> seen_from = points.seen_from;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](const auto& range) {
            std::array<Neighbour, kNearestPoses> nearest;
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                if (points.is_viewed(i)) continue;
                const std::size_t found = tree.nearest(points.tree.position(i), nearest);
                for (std::size_t p = 0; p < found; ++p) {
                    const std::uint32_t pose = first + nearest[p].index;
                    if (!sees(points, planes, cast, i, points.viewpoints[pose])) continue;
                    seen_from[i] = pose;
                    break;
                }
            }
        });
    std::size_t viewed = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        viewed += seen_from[i] != points.seen_from[i];
    points.seen_from = std::move(seen_from);
    return viewed;
}

bool is_seen_by_all(const SurfacePoints& points, const std::vector<LocalPlane>& planes,
                    const Vec3f& viewpoint) {
    // A place farther away than the cloud is wide is an arbitrary zero, not a scanner.
    const PointTree::Node& root = points.tree.nodes.front();
    const Vec3f beside =
        component_max(component_max(root.low - viewpoint, viewpoint - root.high), Vec3f{});
    if (!(length(beside) < length(root.high - root.low))) return false;

    const DiscCast cast(points, planes);
    const std::size_t sample = std::min(points.size(), kWitnesses);
    std::vector<std::uint8_t> seen(sample);
    std::vector<float> distances(sample);
    tbb::parallel_for(std::size_t{0}, sample, [&](std::size_t s) {
        const std::size_t i = s * points.size() / sample;
        seen[s] = sees(points, planes, cast, i, viewpoint);
        distances[s] = length(points.tree.position(i) - viewpoint);
    });
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(sample / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    const auto all = std::count(seen.begin(), seen.end(), std::uint8_t{1});
    return static_cast<double>(all) >= kAllSee * static_cast<double>(sample) &&
           *middle > kScannerSize;
}

}  // namespace glowworm

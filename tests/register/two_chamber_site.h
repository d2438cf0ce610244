#pragma once

#include <algorithm>
#include <vector>

#include "preprocess/register/align.h"
#include "simulated_cave.h"
#include "testing.h"

namespace glowworm::testing {

inline constexpr std::size_t kPoints = 25000;  // of a scan

/// Scans of a cave and where they were taken.
struct Site {
    std::vector<Scan> scans;
    std::vector<Eigen::Isometry3d> truth;  // T_world_scan
};

/// Stations from one chamber through the passage into the other.
inline Site two_chamber_site() {
    const SimulatedCave cave = two_chambers();
    Site site;
    unsigned seed = 1;
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2.2, 0.2, 0), Eigen::Vector3d(5.5, 0.8, 0.2),
          Eigen::Vector3d(9, 1.6, 0.4), Eigen::Vector3d(12.5, 2, 0.5)}) {
        site.truth.push_back(station_at(place, seed));
        site.scans.push_back(scan_cave(cave, site.truth.back(), kPoints, seed++));
    }
    return site;
}

/// Worst error of the placed scans, each relative to the first.
inline PoseError worst_error(const Registration& result,
                             const std::vector<Eigen::Isometry3d>& truth) {
    PoseError worst{0, 0};
    const auto& scans = result.poses.scans;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        if (scans[i].status == PoseStatus::kUnregistered) continue;
        const PoseError e = pose_error(scans[0].T_world_scan.inverse() * scans[i].T_world_scan,
                                       truth[0].inverse() * truth[i]);
        worst = {std::max(worst.degrees, e.degrees), std::max(worst.millimetres, e.millimetres)};
    }
    return worst;
}

/// Scans that are not placed; the result counts them as well.
inline std::size_t unregistered(const Registration& result) {
    std::size_t count = 0;
    for (const ScanPose& pose : result.poses.scans) {
        count += pose.status == PoseStatus::kUnregistered ? 1 : 0;
    }
    EXPECT_EQ(count, result.unregistered);
    return count;
}

/// Moves the points.
inline void turn(Scan& scan, const Eigen::Isometry3d& T) {
    for (Vec3f& p : scan.points.positions) {
        const Eigen::Vector3d q = T * Eigen::Vector3d(p.x, p.y, p.z);
        p = vec3_cast<float>(Vec3d{q.x(), q.y(), q.z()});
    }
}

}  // namespace glowworm::testing

#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "octree/vec3.h"
#include "preprocess/scan.h"

namespace glowworm {

enum class PoseStatus {
    kReference,     ///< holds the world frame
    kRegistered,    ///< placed by registration
    kPrior,         ///< the given pose, kept as it was
    kUnregistered,  ///< could not be placed; never merged
};

/// A direction of motion that the surfaces seen in common leave (nearly) undetermined, as in a
/// straight tunnel.
struct WeakAxis {
    bool rotation = false;   ///< a turn about `axis`, else a shift along it
    Vec3d axis;              ///< unit, world
    double information = 0;  ///< 0: free, 1/3: as firm as a room holds it (see register/trust.h)
};

struct ScanPose {
    std::string file;  ///< as the user named it, "#2" appended for the second scan of a file
    /// Maps the frame of the file (the scan's offset included) to world − Poses::origin.
    Eigen::Isometry3d T_world_scan = Eigen::Isometry3d::Identity();
    PoseStatus status = PoseStatus::kUnregistered;
    double rmse = 0;     ///< m, worst of its accepted pairs
    double overlap = 0;  ///< 0..1, best of its accepted pairs
    /// m and degrees, worst over its accepted pairs; none where no loop passes through it.
    std::optional<double> loop_misclosure, loop_misclosure_deg;
    std::vector<WeakAxis> weak_axes;  ///< world
};

struct PairPose {
    std::string source, target;  ///< ScanPose::file
    Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
    double overlap = 0;       ///< 0..1: share of the source's surface that the target saw as well
    double contradicted = 0;  ///< 0..1: share of the surface in common view that is seen through
    double rmse = 0;          ///< m, of the inliers' distances to the surface
    double p95 = 0;           ///< m, 95 % of the inliers are nearer
    std::uint64_t inliers = 0;
    bool accepted = false;
    std::vector<WeakAxis> weak_axes;  ///< world
};

/// What poses.json holds.
struct Poses {
    Vec3d origin;  ///< m, world; T_world_scan is relative to it
    std::vector<ScanPose> scans;
    std::vector<PairPose> pairs;
};

/// Reads poses.json: any object with scans[].file and scans[].T_world_scan (16 numbers,
/// row-major). All else is optional; a missing status reads as kPrior. Throws Error kUnreadable
/// where the file is not such an object or a matrix is not a rigid motion (1e-3 off).
Poses read_poses(const std::filesystem::path& file);

/// Parses the text of a poses.json; `file` names it in errors.
Poses parse_poses(const std::string& text, const std::filesystem::path& file);

/// The text of poses.json, the same for the same poses.
std::string format_poses(const Poses& poses);

/// Writes poses.json whole or not at all.
void write_poses(const Poses& poses, const std::filesystem::path& file);

/// The pose of `scan`: by its path as the user named it, then by file name where only one entry
/// has that name. Null where there is none.
const ScanPose* find_pose(const Poses& poses, const Scan& scan);

/// How poses.json names `scan`: its path, "#k" appended where its file holds several.
std::string pose_file(const Scan& scan);

std::string to_string(PoseStatus status);

}  // namespace glowworm

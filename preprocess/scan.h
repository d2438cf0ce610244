#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>

#include "preprocess/points.h"

namespace glowworm {

/// What one scanner set-up saw, in the station's own frame.
struct Scan {
    std::string name;  ///< unique among the inputs: file name, "#2" where a file holds several
    std::filesystem::path file;  ///< as the user named it
    Vec3d offset;  ///< m, taken out of the positions: frame position = offset + position
    Points points;
    std::optional<Eigen::Isometry3d> T_world_scan;  ///< the pose the file carries, if it does

    std::string crs;  ///< coordinate reference system as the file states it, mostly empty

    /// Whether the frame's origin is where the scanner stood. Unknown from most files, so it is
    /// decided from the points (see station.h); a SLAM map has no such place.
    bool has_viewpoint = false;
};

}  // namespace glowworm

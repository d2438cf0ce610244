#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "octree/scene.h"

namespace glowworm {

/// Where a camera is at one moment of a flight.
struct PathKey {
    double time = 0.0;  ///< s
    Vec3d position, look_at;
    Vec3d up{0.0, 0.0, 1.0};
    double vfov_deg = 60.0;
    bool by_rotation = false;  ///< given as a rotation: look_at is a point 1 m ahead
};

/// A camera's flight.
struct CameraPath {
    double fps = 30.0;          ///< frames per second, above 0
    std::vector<PathKey> keys;  ///< at least one, in strict order of time
};

/// Reads a path.json. A rotation (quaternion x,y,z,w, world from camera) turns a camera that looks
/// along -Z with +Y up. Throws Error (kUnreadable) with the key that is wrong.
CameraPath read_camera_path(const std::filesystem::path& path);

/// The path as a path.json's text: what read_camera_path reads back.
std::string camera_path_json(const CameraPath& path);

/// Frames from the first key to the last, both counted.
int frame_count(const CameraPath& path);

/// `camera` as it is at a frame: cubic Hermite splines through the keys, whose tangents are the
/// slopes between their neighbours (Catmull-Rom over uneven times). Where all keys look at a point,
/// that point runs along a spline; else quaternions do, each taken with the sign nearer to the one
/// before, made unit again.
Camera camera_at(const CameraPath& path, int frame, const Camera& camera);
/// The same at a time in s; before the first key it is the first, after the last the last.
Camera camera_at_time(const CameraPath& path, double time, const Camera& camera);

}  // namespace glowworm

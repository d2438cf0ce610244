#include "viewer/app/camera_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "octree/output_path.h"
#include "viewer/app/quaternion.h"

namespace glowworm {
namespace {

using Json = nlohmann::json;

constexpr double kMostFrames = 1e6;
constexpr double kMostFps = 1000.0;
constexpr double kFarthest = 1e9;  // m: georeferenced caves lie far closer

[[noreturn]] void fail(const std::string& where, const std::string& what) {
    throw Error(ExitCode::kUnreadable, where + ": " + what);
}

/// `count` finite numbers, or one where count is 0.
std::vector<double> numbers(const Json& json, const char* key, std::size_t count,
                            const std::string& where) {
    const auto found = json.find(key);
    if (found == json.end()) fail(where, fmt::format("'{}' is missing", key));
    const Json list = count == 0 ? Json::array({*found}) : *found;
    const bool fits = list.is_array() && list.size() == std::max<std::size_t>(count, 1) &&
                      std::all_of(list.begin(), list.end(), [](const Json& v) {
                          return v.is_number() && std::isfinite(v.get<double>());
                      });
    if (!fits) {
        fail(where, count == 0 ? fmt::format("'{}' must be a finite number", key)
                               : fmt::format("'{}' must be {} finite numbers", key, count));
    }
    return list.get<std::vector<double>>();
}

Vec3d vector3(const Json& json, const char* key, const std::string& where) {
    const std::vector<double> v = numbers(json, key, 3, where);
    for (const double coordinate : v) {
        if (std::abs(coordinate) > kFarthest) {
            fail(where, fmt::format("'{}' is farther than {} m away", key, kFarthest));
        }
    }
    return {v[0], v[1], v[2]};
}

PathKey read_key(const Json& json, const std::string& where) {
    if (!json.is_object()) fail(where, "it must be an object");
    PathKey key;
    key.time = numbers(json, "time", 0, where)[0];
    key.position = vector3(json, "position", where);
    key.vfov_deg = numbers(json, "vfov_deg", 0, where)[0];
    if (!(key.vfov_deg > 0 && key.vfov_deg < 180)) fail(where, "'vfov_deg' must be in (0, 180)");
    if (json.contains("look_at") == json.contains("rotation")) {
        fail(where, "it needs either 'look_at' or 'rotation'");
    }
    if (json.contains("look_at")) {
        key.look_at = vector3(json, "look_at", where);
        if (!(length(key.look_at - key.position) > 0)) fail(where, "'look_at' is the position");
        return key;
    }
    const std::vector<double> q = numbers(json, "rotation", 4, where);
    const Quaternion given{q[0], q[1], q[2], q[3]};
    if (!(dot(given, given) > 0) || !std::isfinite(dot(given, given))) {
        fail(where, "'rotation' must be a quaternion that is not zero");
    }
    const Quaternion rotation = normalized(given);
    key.by_rotation = true;
    key.up = up_of(rotation);
    key.look_at = key.position + forward_of(rotation);
    return key;
}

/// The spline through value_of each key, after key `i` by `seconds`.
template <typename ValueOf>
auto spline(const std::vector<PathKey>& keys, std::size_t i, double seconds, ValueOf value_of) {
    if (keys.size() == 1) return value_of(0);
    const auto slope = [&](std::size_t k) {
        const std::size_t a = k == 0 ? 0 : k - 1, b = std::min(k + 1, keys.size() - 1);
        return (value_of(b) - value_of(a)) * (1.0 / (keys[b].time - keys[a].time));
    };
    const double span = keys[i + 1].time - keys[i].time;
    const double t = seconds / span;
    const double near_end = t * t * (3.0 - 2.0 * t);
    return value_of(i) * (1.0 - near_end) + value_of(i + 1) * near_end +
           slope(i) * (span * t * (1.0 - t) * (1.0 - t)) +
           slope(i + 1) * (span * t * t * (t - 1.0));
}

/// Each key's turn, with the sign nearer to the one before it.
std::vector<Quaternion> rotations_of(const std::vector<PathKey>& keys) {
    std::vector<Quaternion> rotations;
    for (const PathKey& key : keys) {
        Quaternion q = looking_along(key.look_at - key.position, key.up);
        if (!rotations.empty() && dot(q, rotations.back()) < 0) q = q * -1.0;
        rotations.push_back(q);
    }
    return rotations;
}

Json list_of(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

}  // namespace

CameraPath read_camera_path(const std::filesystem::path& file) {
    const std::string name = fmt::format("'{}'", file.string());
    require_regular_input(file);
    std::ifstream stream(file);
    if (!stream) fail(name, "it cannot be read");
    const Json root = Json::parse(stream, nullptr, false);
    if (!root.is_object()) fail(name, "it is not a JSON object");
    CameraPath path;
    if (root.contains("fps")) path.fps = numbers(root, "fps", 0, name)[0];
    if (!(path.fps > 0 && path.fps <= kMostFps)) {
        fail(name, fmt::format("'fps' must be above 0 and at most {}", kMostFps));
    }
    const auto list = root.find("keyframes");
    if (list == root.end() || !list->is_array() || list->empty()) {
        fail(name, "'keyframes' must be a list of at least one");
    }
    for (const Json& json : *list) {
        const std::string where = fmt::format("keyframe {} of {}", path.keys.size(), name);
        path.keys.push_back(read_key(json, where));
        if (path.keys.size() > 1 && !(path.keys.back().time > path.keys.end()[-2].time)) {
            fail(where, "'time' must be later than the one before");
        }
    }
    if (!((path.keys.back().time - path.keys.front().time) * path.fps < kMostFrames)) {
        fail(name, "it has more than a million frames");
    }
    return path;
}

int frame_count(const CameraPath& path) {
    const double seconds = path.keys.back().time - path.keys.front().time;
    return static_cast<int>(std::floor(seconds * path.fps + 1e-6)) + 1;
}

std::string camera_path_json(const CameraPath& path) {
    nlohmann::ordered_json root{{"fps", path.fps}, {"keyframes", Json::array()}};
    for (const PathKey& key : path.keys) {
        nlohmann::ordered_json json{{"time", key.time}, {"position", list_of(key.position)}};
        if (key.by_rotation) {
            const Quaternion q = looking_along(key.look_at - key.position, key.up);
            json["rotation"] = {q.x, q.y, q.z, q.w};
        } else {
            json["look_at"] = list_of(key.look_at);
        }
        json["vfov_deg"] = key.vfov_deg;
        root["keyframes"].push_back(json);
    }
    return root.dump(1) + "\n";
}

Camera camera_at(const CameraPath& path, int frame, const Camera& camera) {
    return camera_at_time(path, path.keys.front().time + frame / path.fps, camera);
}

Camera camera_at_time(const CameraPath& path, double time, const Camera& camera) {
    const std::vector<PathKey>& keys = path.keys;
    time = std::clamp(time, keys.front().time, keys.back().time);
    std::size_t i = 0;
    while (i + 2 < keys.size() && keys[i + 1].time <= time)
        ++i;
    const double seconds = time - keys[i].time;
    Camera at = camera;
    at.position = spline(keys, i, seconds, [&](std::size_t k) { return keys[k].position; });
    const double vfov_deg =
        spline(keys, i, seconds, [&](std::size_t k) { return keys[k].vfov_deg; });
    at.vfov_deg = std::clamp(vfov_deg, 0.1, 179.0);
    if (std::any_of(keys.begin(), keys.end(), [](const PathKey& k) { return k.by_rotation; })) {
        const std::vector<Quaternion> rotations = rotations_of(keys);
        const Quaternion q =
            normalized(spline(keys, i, seconds, [&](std::size_t k) { return rotations[k]; }));
        at.look_at = at.position + forward_of(q);
        at.up = up_of(q);
    } else {
        at.look_at = spline(keys, i, seconds, [&](std::size_t k) { return keys[k].look_at; });
        at.up = {0, 0, 1};
    }
    return at;
}

}  // namespace glowworm

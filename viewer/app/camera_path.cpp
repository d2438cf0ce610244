#include "viewer/app/camera_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "octree/output_path.h"

namespace glowworm {
namespace {

using Json = nlohmann::json;

constexpr double kMostFrames = 1e6;

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
    const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    if (!(norm > 0)) fail(where, "'rotation' must not be zero");
    const double x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
    key.up = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
    const Vec3d back{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
    key.look_at = key.position - back;
    return key;
}

/// The spline of one member of the keys, after key `i` by `seconds`.
template <typename Member>
auto spline(const std::vector<PathKey>& keys, std::size_t i, double seconds, Member member) {
    if (keys.size() == 1) return keys[0].*member;
    const auto slope = [&](std::size_t k) {
        const PathKey& a = keys[k == 0 ? 0 : k - 1];
        const PathKey& b = keys[std::min(k + 1, keys.size() - 1)];
        return (b.*member - a.*member) * (1.0 / (b.time - a.time));
    };
    const double span = keys[i + 1].time - keys[i].time;
    const double t = seconds / span;
    const double near_end = t * t * (3.0 - 2.0 * t);
    return keys[i].*member * (1.0 - near_end) + keys[i + 1].*member * near_end +
           slope(i) * (span * t * (1.0 - t) * (1.0 - t)) +
           slope(i + 1) * (span * t * t * (t - 1.0));
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
    if (!(path.fps > 0)) fail(name, "'fps' must be above 0");
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

Camera camera_at(const CameraPath& path, int frame, const Camera& camera) {
    const std::vector<PathKey>& keys = path.keys;
    const double time = std::min(keys.front().time + frame / path.fps, keys.back().time);
    std::size_t i = 0;
    while (i + 2 < keys.size() && keys[i + 1].time <= time)
        ++i;
    const double seconds = time - keys[i].time;
    Camera at = camera;
    at.position = spline(keys, i, seconds, &PathKey::position);
    at.look_at = spline(keys, i, seconds, &PathKey::look_at);
    at.up = spline(keys, i, seconds, &PathKey::up);
    at.vfov_deg = std::clamp(spline(keys, i, seconds, &PathKey::vfov_deg), 0.1, 179.0);
    return at;
}

}  // namespace glowworm

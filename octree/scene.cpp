#include "octree/scene.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "octree/output_path.h"

namespace glowworm {
namespace {

using Json = nlohmann::json;

/// One object of the file with the words to name it by when something in it is wrong.
struct Entry {
    const Json& json;
    std::string what;  ///< "light 2 ('red') of 'scene.json'"

    [[noreturn]] void fail(const std::string& key, const std::string& wanted) const {
        throw Error(ExitCode::kUnreadable, what + ": '" + key + "' " + wanted);
    }

    const Json& required(const std::string& key) const {
        const auto found = json.find(key);
        if (found == json.end()) fail(key, "is missing");
        return *found;
    }

    double number(const Json& value, const std::string& key) const {
        if (!value.is_number() || !std::isfinite(value.get<double>())) {
            fail(key, "must be made of finite numbers");
        }
        return value.get<double>();
    }

    double number(const std::string& key) const { return number(required(key), key); }

    Vec3d vector(const Json& value, const std::string& key) const {
        if (!value.is_array() || value.size() != 3) fail(key, "must be a list of three numbers");
        return {number(value[0], key), number(value[1], key), number(value[2], key)};
    }

    Vec3d vector(const std::string& key) const { return vector(required(key), key); }

    Vec3f channels(const std::string& key) const {
        const Vec3d value = vector(key);
        if (value.x < 0 || value.y < 0 || value.z < 0) fail(key, "must not be negative");
        return vec3_cast<float>(value);
    }

    Vec3d direction(const std::string& key) const {
        const Vec3d value = vector(key);
        if (!(length(value) > 0)) fail(key, "must not be zero");
        return normalized(value);
    }

    std::string text(const std::string& key) const {
        const Json& value = required(key);
        if (!value.is_string()) fail(key, "must be a text");
        return value.get<std::string>();
    }
};

AreaLight read_area_light(const Entry& light) {
    AreaLight area{light.text("name"), {}, light.channels("radiance")};
    const Json& corners = light.required("corners");
    if (!corners.is_array() || corners.size() != 4) light.fail("corners", "must be four points");
    for (std::size_t i = 0; i < 4; ++i)
        area.corners[i] = light.vector(corners[i], "corners");
    return area;
}

void read_light(const Entry& light, Scene& scene) {
    const std::string type = light.text("type");
    if (type == "point") {
        scene.point_lights.push_back(
            {light.text("name"), light.vector("position"), light.channels("radiant_intensity")});
    } else if (type == "spot") {
        SpotLight spot;
        spot.name = light.text("name");
        spot.position = light.vector("position");
        spot.direction = light.direction("direction");
        spot.cone_deg = light.number("cone_deg");
        spot.blend = light.number("blend");
        spot.radiant_intensity = light.channels("radiant_intensity");
        if (!(spot.cone_deg > 0 && spot.cone_deg <= 180))
            light.fail("cone_deg", "must be in (0, 180]");
        if (!(spot.blend >= 0 && spot.blend <= 1)) light.fail("blend", "must be in [0, 1]");
        scene.spot_lights.push_back(spot);
    } else if (type == "area") {
        scene.area_lights.push_back(read_area_light(light));
    } else {
        light.fail("type", "is '" + type + "', not point, spot or area");
    }
}

Camera read_camera(const Entry& entry) {
    Camera camera;
    camera.name = entry.text("name");
    camera.position = entry.vector("position");
    camera.look_at = entry.vector("look_at");
    camera.up = entry.direction("up");
    camera.vfov_deg = entry.number("vfov_deg");
    const double width = entry.number("width"), height = entry.number("height");
    if (!(camera.vfov_deg > 0 && camera.vfov_deg < 180))
        entry.fail("vfov_deg", "must be in (0, 180)");
    if (!(width >= 1 && width <= 16384)) entry.fail("width", "must be in 1..16384");
    if (!(height >= 1 && height <= 16384)) entry.fail("height", "must be in 1..16384");
    if (!(length(camera.look_at - camera.position) > 0)) entry.fail("look_at", "is the position");
    camera.width = static_cast<int>(width);
    camera.height = static_cast<int>(height);
    return camera;
}

/// Calls `read` for each object in the list `key`; an absent list is an empty one.
template <typename Read>
void for_each_entry(const Json& root, const char* key, const char* word, const std::string& file,
                    Read read) {
    const auto list = root.find(key);
    if (list == root.end()) return;
    if (!list->is_array()) {
        throw Error(ExitCode::kUnreadable, "'" + file + "': '" + key + "' must be a list");
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
        const Json& json = (*list)[i];
        std::string what = std::string(word) + " " + std::to_string(i);
        if (json.is_object() && json.contains("name") && json["name"].is_string()) {
            what += " ('" + json["name"].get<std::string>() + "')";
        }
        what += " of '" + file + "'";
        if (!json.is_object()) throw Error(ExitCode::kUnreadable, what + " must be an object");
        read(Entry{json, what});
    }
}

}  // namespace

Scene read_scene(const std::filesystem::path& path) {
    require_regular_input(path);
    std::ifstream stream(path);
    if (!stream)
        throw Error(ExitCode::kUnreadable, "cannot read the scene '" + path.string() + "'");
    const Json root = Json::parse(stream, nullptr, false);
    if (root.is_discarded() || !root.is_object()) {
        throw Error(
            ExitCode::kUnreadable,
            "'" + path.string() + "' is not a scene: a JSON object with lights and cameras");
    }

    Scene scene;
    for_each_entry(root, "lights", "light", path.string(),
                   [&](const Entry& light) { read_light(light, scene); });
    for_each_entry(root, "cameras", "camera", path.string(),
                   [&](const Entry& camera) { scene.cameras.push_back(read_camera(camera)); });
    return scene;
}

}  // namespace glowworm

#include "octree/scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "octree/output_path.h"

namespace glowworm {
namespace {

using Json = nlohmann::json;

/// Beyond any place or lamp, and with squares that floats still hold: light stays finite.
constexpr double kLargest = 1e12;

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
        if (!value.is_number() || !(std::abs(value.get<double>()) <= kLargest)) {
            fail(key, "must be made of finite numbers, none beyond 1e12");
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

/// What of `json` is none of `known`, as text; empty where nothing is left.
std::string unknown_keys(Json json, std::initializer_list<const char*> known) {
    for (const char* key : known)
        json.erase(key);
    return json.empty() ? std::string() : json.dump();
}

constexpr std::initializer_list<const char*> kPointKeys = {"type", "name", "position",
                                                           "radiant_intensity"};
constexpr std::initializer_list<const char*> kSpotKeys = {
    "type", "name", "position", "direction", "cone_deg", "blend", "radiant_intensity"};
constexpr std::initializer_list<const char*> kAreaKeys = {"type", "name", "corners", "radiance"};
constexpr std::initializer_list<const char*> kCameraKeys = {"name",     "position", "look_at", "up",
                                                            "vfov_deg", "width",    "height"};
constexpr std::initializer_list<const char*> kSceneKeys = {"lights", "cameras"};

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
        scene.point_lights.push_back({light.text("name"), light.vector("position"),
                                      light.channels("radiant_intensity"),
                                      unknown_keys(light.json, kPointKeys)});
    } else if (type == "spot") {
        SpotLight spot;
        spot.name = light.text("name");
        spot.position = light.vector("position");
        spot.direction = light.direction("direction");
        spot.cone_deg = light.number("cone_deg");
        spot.blend = light.number("blend");
        spot.radiant_intensity = light.channels("radiant_intensity");
        spot.unknown = unknown_keys(light.json, kSpotKeys);
        if (!(spot.cone_deg > 0 && spot.cone_deg <= 180))
            light.fail("cone_deg", "must be in (0, 180]");
        if (!(spot.blend >= 0 && spot.blend <= 1)) light.fail("blend", "must be in [0, 1]");
        scene.spot_lights.push_back(spot);
    } else if (type == "area") {
        scene.area_lights.push_back(read_area_light(light));
        scene.area_unknown.push_back(unknown_keys(light.json, kAreaKeys));
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
    camera.unknown = unknown_keys(entry.json, kCameraKeys);
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

/// Throws Error where `text` is no JSON, with the place: NaN and Infinity are how it often comes.
Json parse(const std::string& text, const std::string& file) {
    try {
        return Json::parse(text);
    } catch (const Json::parse_error& error) {
        const std::size_t at = std::min(text.size(), error.byte > 0 ? error.byte - 1 : 0);
        const auto line = 1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n');
        const std::size_t word = text.find_last_of(" \t\n:,[{", at > 0 ? at - 1 : 0) + 1;
        const std::string near = text.substr(word, text.find_first_of(" \t\n,]}", word) - word);
        const bool is_number = near.ends_with("NaN") || near.ends_with("nan") ||
                               near.ends_with("nfinity") || near.ends_with("inf");
        throw Error(ExitCode::kUnreadable,
                    "'" + file + "' is not a scene: line " + std::to_string(line) + " is no JSON" +
                        (near.empty() ? "" : " at '" + near.substr(0, 40) + "'") +
                        (is_number ? "; write finite numbers" : "; mend or export it again"));
    } catch (const Json::out_of_range&) {
        throw Error(ExitCode::kUnreadable, "'" + file +
                                               "' is not a scene: it holds a number beyond 1e308; "
                                               "write finite numbers");
    }
}

/// An object to be written: the keys that were kept, then ours.
struct Written {
    using Value = nlohmann::ordered_json;

    explicit Written(const std::string& unknown)
        : value(unknown.empty() ? Value::object() : Value::parse(unknown)) {}
    template <typename T>
    Written& operator()(const char* key, const T& content) {
        value[key] = content;
        return *this;
    }

    Value value;
};

template <typename T>
Written::Value list_of(const Vec3<T>& v) {
    return {v.x, v.y, v.z};
}

}  // namespace

Scene read_scene(const std::filesystem::path& path) {
    require_regular_input(path);
    std::ifstream stream(path);
    if (!stream)
        throw Error(ExitCode::kUnreadable, "cannot read the scene '" + path.string() + "'");
    const Json root = parse({std::istreambuf_iterator<char>(stream), {}}, path.string());
    if (!root.is_object()) {
        throw Error(
            ExitCode::kUnreadable,
            "'" + path.string() + "' is not a scene: a JSON object with lights and cameras");
    }

    Scene scene;
    for_each_entry(root, "lights", "light", path.string(),
                   [&](const Entry& light) { read_light(light, scene); });
    for_each_entry(root, "cameras", "camera", path.string(),
                   [&](const Entry& camera) { scene.cameras.push_back(read_camera(camera)); });
    scene.unknown = unknown_keys(root, kSceneKeys);
    return scene;
}

std::string scene_json(const Scene& scene) {
    Written root(scene.unknown);
    Written::Value lights = Written::Value::array(), cameras = Written::Value::array();
    for (const PointLight& light : scene.point_lights) {
        Written json(light.unknown);
        json("type", "point")("name", light.name)("position", list_of(light.position));
        json("radiant_intensity", list_of(light.radiant_intensity));
        lights.push_back(json.value);
    }
    for (const SpotLight& light : scene.spot_lights) {
        Written json(light.unknown);
        json("type", "spot")("name", light.name)("position", list_of(light.position));
        json("direction", list_of(light.direction))("cone_deg", light.cone_deg);
        json("blend", light.blend)("radiant_intensity", list_of(light.radiant_intensity));
        lights.push_back(json.value);
    }
    for (std::size_t i = 0; i < scene.area_lights.size(); ++i) {
        const AreaLight& light = scene.area_lights[i];
        Written json(i < scene.area_unknown.size() ? scene.area_unknown[i] : "");
        Written::Value corners = Written::Value::array();
        for (const Vec3d& corner : light.corners)
            corners.push_back(list_of(corner));
        json("type", "area")("name", light.name)("corners", corners);
        json("radiance", list_of(light.radiance));
        lights.push_back(json.value);
    }
    for (const Camera& camera : scene.cameras) {
        Written json(camera.unknown);
        json("name", camera.name)("position", list_of(camera.position));
        json("look_at", list_of(camera.look_at))("up", list_of(camera.up));
        json("vfov_deg", camera.vfov_deg)("width", camera.width)("height", camera.height);
        cameras.push_back(json.value);
    }
    root("lights", lights)("cameras", cameras);
    return root.value.dump(1) + "\n";
}

}  // namespace glowworm

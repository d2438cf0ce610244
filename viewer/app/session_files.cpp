// What the window saves and opens.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "octree/error.h"
#include "octree/output_path.h"
#include "viewer/app/default_scene.h"
#include "viewer/app/picture_file.h"
#include "viewer/app/session.h"

namespace glowworm {
namespace {

constexpr const char* kViewCamera = "view";  // what a saved scene calls the window's camera

/// "glowworm-N" with the first N for which the current folder has no picture and no scene.
std::string free_picture_name() {
    const auto taken = [](int number) {
        return std::ranges::any_of(std::array{"png", "exr", "json"}, [&](const char* ending) {
            std::error_code ignored;
            return std::filesystem::exists(fmt::format("glowworm-{}.{}", number, ending), ignored);
        });
    };
    int number = 1;
    while (taken(number))
        ++number;
    return fmt::format("glowworm-{}", number);
}

}  // namespace

/// The lights as they are, and first among the cameras the window's own.
Scene Session::scene_to_save(int width, int height) const {
    Scene scene = saved_with_lamps(scene_, state_.lamps);
    if (state_.headlamp_on) {
        Camera eye;
        eye.position = headlamp_eye_;
        scene.point_lights.push_back(headlamp_at(eye, state_.headlamp_intensity));
    }
    std::erase_if(scene.cameras, [](const Camera& c) { return c.name == kViewCamera; });
    Camera camera = navigator_.camera().camera(width, height);
    camera.name = kViewCamera;
    scene.cameras.insert(scene.cameras.begin(), camera);
    return scene;
}

/// At the window's size. While it is drawn the window goes on answering, and closing it gives up.
void Session::save_picture() {
    const WindowExtent size = window_.framebuffer();
    if (size.width == 0 || size.height == 0) return;
    if (!intact_) return say("the file was cut: there is no picture to save");
    const std::string name = free_picture_name();
    const auto report = [&](std::uint64_t done, std::uint64_t total) {
        say(fmt::format("saving {}.png: {} %", name,
                        100 * done / std::max<std::uint64_t>(total, 1)));
        window_.poll(0.0);
        show(0.0);
        if (!goes_on()) throw Error(ExitCode::kCancelled, "cancelled; no picture was saved");
    };
    try {
        require_writable_output(name + ".png", true);  // before time is spent on it
        report(0, 1);
        if (!light_) make_light(ground_.valid() ? ground_.get() : ground());
        relight_if_changed();
        const View view = view_of_size(size.width, size.height);
        const FrameLayers layers = frame_.render(view, light_->field(), report);
        const DisplaySettings shown{state_.exposure, state_.curve};
        write_frame(layers, view, shown, name + ".exr");
        write_whole(name + ".json", scene_json(scene_to_save(size.width, size.height)));
        write_frame(layers, view, shown, name + ".png");
        say(fmt::format("saved {0}.png, {0}.exr and their scene {0}.json", name));
    } catch (const Error& error) {
        say(error.what());
    }
}

void Session::save_scene() {
    const WindowExtent size = window_.framebuffer();
    write_and_say(state_.scene_file,
                  scene_json(scene_to_save(std::max(size.width, 1), std::max(size.height, 1))));
}

/// Lights and the first camera of another scene; undo brings the lamps back.
void Session::load_scene(const std::filesystem::path& path) {
    try {
        Scene scene = read_scene(path);
        const auto headlamp = take_headlamp(scene);
        state_.headlamp_on = headlamp.has_value();
        if (headlamp) state_.headlamp_intensity = headlamp->radiant_intensity;
        state_.lamps = lamps_of(scene);
        state_.selected = dragged_lamp_ = -1;
        if (!scene.cameras.empty()) navigator_.go_to(scene.cameras.front());
        // The headlamp follows in steps: it may have been left a little behind.
        headlamp_eye_ = headlamp ? headlamp->eye : navigator_.camera().position();
        scene_ = std::move(scene);
        say(fmt::format("loaded '{}'", path.string()));
        moved();
    } catch (const Error& error) {
        say(error.what());
    }
}

void Session::save_path() {
    if (state_.path.keys.empty()) return say("the path has no keyframes yet: K adds one");
    write_and_say("glowworm-path.json", camera_path_json(state_.path));
}

/// An octree is opened next; a scene or a path is taken into this one.
void Session::take(const FileDrop& drop) {
    const std::filesystem::path& path = drop.path;
    try {
        if (path.extension() == ".svo") {
            const LightLevel level{options_.light_depth, options_.light_memory, options_.light};
            next_ = NextCave{path, open_cave(path, level)};
        } else if (path.extension() == ".json") {
            try {
                state_.path = read_camera_path(path);
                say(fmt::format("loaded the path '{}'", path.string()));
            } catch (const Error&) {
                load_scene(path);  // whose sentence is the one that counts
            }
        } else {
            say(fmt::format(
                "'{}' is no .svo, scene or path; `glowworm convert` makes an .svo of scans",
                path.string()));
        }
    } catch (const Error& error) {
        say(error.what());
    }
}

void Session::write_and_say(const std::filesystem::path& path, const std::string& text) {
    try {
        write_whole(path, text);
        say(fmt::format("saved {}", path.string()));
    } catch (const Error& error) {
        say(error.what());
    }
}

}  // namespace glowworm

// What the window saves and opens.
#include <fmt/format.h>

#include <algorithm>

#include "octree/error.h"
#include "viewer/app/default_scene.h"
#include "viewer/app/picture_file.h"
#include "viewer/app/session.h"

namespace glowworm {
namespace {

constexpr const char* kViewCamera = "view";  // what a saved scene calls the window's camera

}  // namespace

/// The lights as they are, and first among the cameras the window's own.
Scene Session::scene_to_save(int width, int height) const {
    Scene scene = saved_with_lamps(start_.scene, state_.lamps);
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

/// The next free glowworm-N.png, .exr and .json in the current folder, at the window's size.
void Session::save_picture() {
    const WindowExtent size = window_.framebuffer();
    if (size.width == 0 || size.height == 0) return;
    int number = 1;
    while (std::filesystem::exists(fmt::format("glowworm-{}.png", number)))
        ++number;
    const std::string name = fmt::format("glowworm-{}", number);
    relight_if_changed();
    try {
        const View view = view_of_size(size.width, size.height);
        const FrameLayers layers = frame_.render(view, light_->field());
        const DisplaySettings shown{state_.exposure, state_.curve};
        write_frame(layers, view, shown, name + ".exr");
        write_whole(name + ".json", scene_json(scene_to_save(size.width, size.height)));
        write_frame(layers, view, shown, name + ".png");
        state_.message = fmt::format("saved {0}.png, {0}.exr and their scene {0}.json", name);
    } catch (const Error& error) {
        state_.message = error.what();
    }
    drawn_ = {};  // the frame's surfaces are gone
    stale_ = true;
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
        if (!scene.cameras.empty()) {
            navigator_.go_to(scene.cameras.front());
        }
        // The headlamp follows in steps: it may have been left a little behind.
        headlamp_eye_ = headlamp ? headlamp->eye : navigator_.camera().position();
        start_.scene = scene;
        state_.message = fmt::format("loaded '{}'", path.string());
        moved();
    } catch (const Error& error) {
        state_.message = error.what();
    }
}

/// An octree is opened next; a scene or a path is taken into this one.
void Session::take_drop(const std::filesystem::path& path) {
    try {
        if (path.extension() == ".svo") {
            const LightLevel level{options_.light_depth, options_.light_memory, options_.light};
            next_ = NextCave{path, open_cave(path, level)};
        } else if (path.extension() == ".json") {
            try {
                state_.path = read_camera_path(path);
                state_.message = fmt::format("loaded the path '{}'", path.string());
            } catch (const Error&) {
                load_scene(path);  // whose sentence is the one that counts
            }
        } else {
            state_.message = fmt::format(
                "'{}' is no .svo, scene or path; `glowworm convert` makes an .svo of scans",
                path.string());
        }
    } catch (const Error& error) {
        state_.message = error.what();
    }
}

void Session::write_and_say(const std::filesystem::path& path, const std::string& text) {
    try {
        write_whole(path, text);
        state_.message = fmt::format("saved {}", path.string());
    } catch (const Error& error) {
        state_.message = error.what();
    }
}

}  // namespace glowworm

#include "viewer/app/beginning.h"

#include "viewer/app/default_scene.h"
#include "viewer/app/file_facts.h"

namespace glowworm {
namespace {

/// Takes the headlamp out of `scene`: it moves with the camera.
WindowState state_of(const Options& options, const Cave& cave, Scene& scene) {
    WindowState state;
    const auto headlamp = take_headlamp(scene);
    state.headlamp_on = headlamp.has_value();
    if (headlamp) state.headlamp_intensity = headlamp->radiant_intensity;
    state.lamps = lamps_of(scene);
    state.curve = options.display.curve;
    state.automatic_exposure = !options.display.exposure;
    state.exposure = static_cast<float>(options.display.exposure.value_or(0.0));
    state.pixels_between_points = options.frame.selection.quality;
    state.wetness = options.frame.wetness;
    state.level = static_cast<int>(cave.light().grid.depth);
    state.levels = state.level + 1;
    state.scheme = options.controls;
    state.light = options.light;
    state.limit_bounces = options.bounces.has_value();
    state.bounces = options.bounces.value_or(state.bounces);
    for (const StationRecord& station : cave.points().stations) {
        state.stations.push_back(
            {std::string(cave.points().names.substr(station.name_offset, station.name_bytes)),
             {station.position[0], station.position[1], station.position[2]}});
    }
    state.file_facts = file_facts(options.octree, cave);
    state.scene_file = options.scene.empty() ? "glowworm-scene.json" : options.scene.string();
    return state;
}

}  // namespace

Beginning beginning_of(const Options& options, const Cave& cave) {
    Start start = start_of(cave.points(), options.scene, options.camera);
    WindowState state = state_of(options, cave, start.scene);
    Navigator navigator(cave.points(), start.camera, options.controls);
    state.clip_box = navigator.bounds();
    state.vfov_deg = static_cast<float>(navigator.camera().vfov_deg());
    History<std::vector<Lamp>> history(state.lamps);
    return {std::move(start), std::move(state), std::move(navigator), std::move(history)};
}

}  // namespace glowworm

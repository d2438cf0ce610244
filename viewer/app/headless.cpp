#include "viewer/app/headless.h"

#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "octree/output_path.h"
#include "viewer/app/benchmark.h"
#include "viewer/app/flight.h"
#include "viewer/app/grouped_light.h"
#include "viewer/app/lamps.h"
#include "viewer/app/picture_file.h"
#include "viewer/app/probes.h"
#include "viewer/app/start.h"
#include "viewer/gpu/context.h"
#include "viewer/light/light_field.h"
#include "viewer/light/light_meter.h"

namespace glowworm {
namespace {

using Json = nlohmann::ordered_json;

/// How light is gathered, and on what.
Json method_of(const Cave& cave, const Options& options) {
    Json method{{"light_depth", cave.light().grid.depth}};
    if (cave.light_groups > 0) method["light_groups"] = cave.light_groups;
    if (options.light.gather == Gather::kLinks) {
        method["links"] = options.light.links;
    } else {
        method["cones"] = options.light.cones;
        method["faithful"] = options.light.faithful;
    }
    return method;
}

/// Reflects the light as often as the options say.
Json propagate(LightField& light, const Options& options, Console& console) {
    if (options.bounces == 0) return {{"bounces", 0}};
    light.prepare(console.phase("links", "lobes"));
    console.phase("light", "bounces");
    if (options.bounces) {
        light.iterate(*options.bounces);
        return {{"bounces", *options.bounces}};
    }
    const Convergence result = light.converge();
    if (!result.settled) {
        spdlog::warn("the light has not settled after {} bounces: the last changed it by {:.2g} %",
                     result.bounces, result.residual * 100.0);
    }
    return {
        {"bounces", result.bounces}, {"residual", result.residual}, {"settled", result.settled}};
}

/// What light is to be good at: where it is measured, else what the camera sees.
std::vector<Vec3d> places_of_interest(const Start& start, const Options& options) {
    if (options.probes.empty()) return {start.camera.position};
    std::vector<Vec3d> places;
    for (const MeterPoint& point : read_probes(options.probes).probes)
        places.push_back(point.position);
    return places;
}

Json measure_probes(const LightField& light, const Options& options, Console& console) {
    const ProbeTable table = read_probes(options.probes);
    console.phase("probes", "probes");
    std::vector<Probe> probes;
    for (const MeterPoint& point : table.probes) {
        probes.push_back({point.position, vec3_cast<float>(point.normal)});
    }
    std::vector<Irradiance> measured;
    std::size_t off_surface = 0;
    for (const ProbeResult& result : measure_light(light, probes)) {
        measured.push_back({result.direct, result.indirect});
        off_surface += result.on_surface ? 0 : 1;
    }
    write_whole(options.output, format_probes(table, measured));
    if (off_surface > 0) {
        spdlog::warn(
            "{} of {} probes lie on no surface that faces their way: they read no indirect light; "
            "check their positions and normals",
            off_surface, probes.size());
    }

    Json result{{"probes", measured.size()}, {"off_surface", off_surface}};
    if (const auto differences = compare_probes(table, measured)) {
        const auto json_of = [](const Difference& d) {
            return Json{{"mean_relative", d.mean}, {"worst_relative", d.worst}};
        };
        result["direct"] = json_of(differences->direct);
        result["indirect"] = json_of(differences->indirect);
    }
    return result;
}

Json render_frame(const Context& context, const Cave& cave, const LightField& light,
                  const Start& start, const Options& options, Console& console) {
    const Camera camera = sized_camera(start.camera, options);
    const View view = view_of(camera);
    Frame frame(context, cave.points(), options.frame);
    frame.set_panels(start.scene.area_lights);
    const FrameLayers layers = frame.render(view, light, console.phase("frame", "pixels"));
    cave.file.require_intact();
    if (frame.surfels_without_room() > 0) {
        spdlog::warn(
            "drawn coarser than it is: --gpu-memory has no room for {} of the points this view "
            "wants",
            frame.surfels_without_room());
    }

    Json result{{"camera", camera.name}, {"width", camera.width}, {"height", camera.height}};
    const double stops = write_frame(layers, view, options.display, options.output);
    if (options.output.extension() == ".exr") return result;
    spdlog::info("exposed by {:.2f} EV", stops);
    result["exposure"] = stops;
    result["tonemap"] = kToneCurveNames[static_cast<int>(options.display.curve)];
    return result;
}

}  // namespace

Json run_headless(const Options& options, const Cave& cave, Console& console) {
    const std::filesystem::path& output = options.stats.empty() ? options.output : options.stats;
    std::optional<CameraPath> path;
    if (options.path.empty()) {
        require_writable_output(output, options.force);
        require_distinct(output, {options.octree, options.scene, options.probes});
    } else {
        path = prepare_flight(options);
    }
    Start start = start_of(cave.points(), options.scene, options.camera);
    start.scene = with_lamps(start.scene, lamps_of(start.scene));  // what is off is dark

    console.phase("upload", "");
    const Context context = Context::headless();
    spdlog::debug("drawing on {}, OpenGL {}", context.device().renderer, context.device().version);
    LightField light(context, cave.light(), start.scene, options.light);
    if (options.frame.wetness > 0.0f && !light.fits_shaders()) {
        spdlog::warn(
            "walls are drawn dry: shaders of this OpenGL see at most {} MiB at once, and the light "
            "of this cave takes more; --light-depth makes it coarser",
            context.device().max_storage_bytes >> 20);
    }
    cave.file.require_intact();

    std::optional<GroupedLight> grouped;
    if (cave.light_groups > 0 && options.bounces != 0) {
        grouped.emplace(cave.light(), options.light, cave.light_groups);
        grouped->look_from(places_of_interest(start, options), start.scene, light,
                           console.phase("links", "groups"));
    }

    Json result{{"output", output.string()}, {"renderer", context.device().renderer}};
    result.update(method_of(cave, options));
    result.update(propagate(light, options, console));
    if (!options.stats.empty()) {
        console.phase("benchmark", "frames");
        result.update(run_benchmark(context, cave, light, start, options));
    } else if (path) {
        result.update(render_flight(context, cave, light, grouped ? &*grouped : nullptr, start,
                                    *path, options, console.phase("flight", "frames")));
    } else if (!options.probes.empty()) {
        result.update(measure_probes(light, options, console));
    } else {
        result.update(render_frame(context, cave, light, start, options, console));
    }
    for (const std::string& error : context.errors())
        spdlog::warn("OpenGL: {}", error);
    return result;
}

}  // namespace glowworm

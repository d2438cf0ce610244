#include "viewer/app/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>

#include "octree/error.h"
#include "octree/node_layout.h"
#include "viewer/app/video_encoder.h"

namespace glowworm {
namespace {

constexpr int kLargestEdge = 16384;  // pixels

[[noreturn]] void fail(const std::string& sentence) {
    throw Error(ExitCode::kUsage, sentence + "; `glowworm-view --help` shows what there is");
}

PictureSize size_of(const std::string& text) {
    PictureSize size{};
    const char* end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, size.width);
    if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
        const auto height = std::from_chars(width.ptr + 1, end, size.height);
        const auto fits = [](int edge) { return edge >= 1 && edge <= kLargestEdge; };
        if (height.ec == std::errc() && height.ptr == end && fits(size.width) &&
            fits(size.height)) {
            return size;
        }
    }
    fail(fmt::format("--size '{}' is not WIDTHxHEIGHT in 1..{} pixels", text, kLargestEdge));
}

/// What CLI::Range is for integers. That one lets "nan" pass, as no comparison refuses it.
CLI::Validator number_in(double low, double high) {
    const std::string range = fmt::format("{} to {}", low, high);
    return CLI::Validator(
        [=](const std::string& text) {
            double value = 0.0;
            const bool fits =
                CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
            return fits ? std::string() : fmt::format("'{}' is not a number in {}", text, range);
        },
        "in " + range);
}

/// A flight becomes a video, or numbered frames where the output is a folder.
void check_flight(const CLI::App& app, const Options& options) {
    const bool exr = options.frame_format == "exr";
    if (is_video_name(options.output)) {
        if (app.count("--frame-format") > 0) fail("--frame-format is for a folder of frames");
    } else if (!options.output.extension().empty() &&
               !std::filesystem::is_directory(options.output)) {
        fail(
            fmt::format("--path writes a video or a folder of frames: '{}' must end in .mp4, "
                        ".m4v, .mov or .mkv, or be a folder's name without an ending",
                        options.output.string()));
    }
    if (exr && (app.count("--tonemap") > 0 || app.count("--exposure") > 0)) {
        fail("an EXR holds radiance: --exposure and --tonemap are for PNG and videos");
    }
}

/// What only makes sense together, in a sentence each.
void check_combination(const CLI::App& app, const Options& options) {
    if (!options.headless) {
        for (const char* flag :
             {"--output", "--probes", "--path", "--samples", "--json", "--force", "--stats"}) {
            if (app.count(flag) > 0) fail(fmt::format("{} needs --headless", flag));
        }
        return;
    }
    if (app.count("--frames") != app.count("--stats")) {
        fail("a benchmark takes both --frames and --stats");
    }
    if (!options.stats.empty()) {
        for (const char* flag : {"--output", "--probes", "--path", "--exposure", "--samples"}) {
            if (app.count(flag) > 0) fail(fmt::format("{} does not go with --stats", flag));
        }
        return;
    }
    if (options.output.empty()) fail("--headless needs -o, the file to write");
    const std::string ending = options.output.extension().string();
    if (!options.path.empty()) {
        for (const char* flag : {"--probes", "--camera"}) {
            if (app.count(flag) > 0) fail(fmt::format("{} does not go with --path", flag));
        }
        check_flight(app, options);
        return;
    }
    if (app.count("--frame-format") > 0) fail("--frame-format goes with --path");
    if (options.probes.empty()) {
        if (ending != ".exr" && ending != ".png") {
            fail(fmt::format("the frame '{}' must end in .exr or .png", options.output.string()));
        }
        if (ending == ".exr" && (app.count("--tonemap") > 0 || app.count("--exposure") > 0)) {
            fail("an EXR holds radiance: --exposure and --tonemap are for PNG");
        }
        return;
    }
    for (const char* flag : {"--camera", "--size", "--exposure", "--tonemap", "--samples",
                             "--specular", "--wetness"}) {
        if (app.count(flag) > 0) fail(fmt::format("{} is for frames, not for --probes", flag));
    }
}

}  // namespace

Camera sized_camera(const Camera& camera, const Options& options) {
    Camera sized = camera;
    if (options.size) {
        sized.width = options.size->width;
        sized.height = options.size->height;
    }
    return sized;
}

std::optional<Options> read_options(int argc, char** argv) {
    Options options;
    std::string size, tonemap = kToneCurveNames[static_cast<int>(options.display.curve)];
    std::string interpolation = "tricubic", controls = "fly";
    int bounces = 0;
    std::uint32_t light_depth = 0;
    double exposure = 0.0;
    bool converge = false;
    std::string specular = "off";
    double wetness = 0.0;

    CLI::App app{"Walks through a cave's octree with the light that lamps and walls make.",
                 "glowworm-view"};
    app.set_version_flag("--version", "glowworm-view " GLOWWORM_VERSION);
    app.set_config("--config", "", "read flags from this TOML file; the command line wins");
    app.add_option("octree", options.octree, "the .svo file")->required();
    app.add_option("--scene", options.scene,
                   "lights and cameras (scene.json); without it a lamp at "
                   "each station and a headlamp");
    app.add_option("--camera", options.camera, "a camera of the scene; the first without it");
    app.add_flag("--headless", options.headless, "write a file and show nothing; needs no display");
    app.add_option("-o,--output", options.output,
                   "frame.exr, frame.png, the probes' CSV, or a flight's video or folder");
    auto* controls_option =
        app.add_option("--controls", controls,
                       "what the mouse does in the window: fly, or as in potree, aven or cad "
                       "(left picks, middle turns)")
            ->check(CLI::IsMember({"fly", "potree", "aven", "cad"}))
            ->capture_default_str();
    app.add_option("--probes", options.probes, "measure irradiance at this CSV's points");
    app.add_option("--path", options.path,
                   "fly along this path.json: into a video (.mp4, .m4v, .mov, .mkv; needs ffmpeg), "
                   "or into a folder as numbered frames");
    app.add_option("--frame-format", options.frame_format,
                   "of a folder's frames: png (exposed) or exr (linear, with layers)")
        ->check(CLI::IsMember({"png", "exr"}))
        ->capture_default_str();
    app.add_option("--size", size, "WIDTHxHEIGHT in pixels; the camera's without it");

    app.add_option("--frames", options.frames,
                   "draw this many frames: a benchmark with --headless, "
                   "else the window closes after them")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--stats", options.stats, "where a benchmark's milliseconds per pass go (JSON)");

    auto* bounces_option = app.add_option("--bounces", bounces,
                                          "how often light is reflected; 0 is "
                                          "direct light only")
                               ->check(CLI::Range(0, 100000));
    app.add_flag("--converge", converge,
                 "reflect until the light settles; so it is without --bounces")
        ->excludes(bounces_option);
    auto* faithful_option =
        app.add_flag("--faithful", options.light.faithful,
                     "gather light as the 2016 paper did: its six cones, without our improvements");
    auto* cones_option = app.add_option("--cones", options.light.cones,
                                        "gather light by this many cones per lobe (4, 5, 6, 9, 10 "
                                        "or 16) instead of along traced links")
                             ->check(CLI::IsMember({4, 5, 6, 9, 10, 16}))
                             ->excludes(faithful_option);
    auto* light_depth_option = app.add_option("--light-depth", light_depth,
                                              "simulate light on leaves at this level, at most the "
                                              "file's depth")
                                   ->check(CLI::Range(1u, kMaxDepth));
    auto* light_memory_option =
        app.add_option("--light-memory", options.light_memory,
                       "what light may take (2G, 500M; 0: any), its links included: a cave that "
                       "needs more has light of groups of lobes, small near the camera and lamps, "
                       "and that is said (1536M; with --light-depth any)")
            ->transform(CLI::AsSizeValue(false));
    app.add_option("--interpolation", interpolation, "between leaves: trilinear or tricubic")
        ->check(CLI::IsMember({"trilinear", "tricubic"}));
    auto* specular_option =
        app.add_option("--specular", specular,
                       "on: walls mirror as if a film of water lay on them; off: they are "
                       "Lambertian, as a path tracer's diffuse walls are (the default)")
            ->check(CLI::IsMember({"on", "off"}));
    auto* wetness_option =
        app.add_option("--wetness", wetness,
                       "how much of the walls is wet, 0 to 1; above 0 it turns --specular on")
            ->check(number_in(0.0, 1.0));
    app.add_option("--quality", options.frame.selection.quality,
                   "pixels between drawn points; more is coarser and faster")
        ->check(number_in(0.1, 100.0))
        ->capture_default_str();
    app.add_option("--points", options.frame.selection.most_surfels,
                   "points in a frame at most, 0 for no limit; a denser view is drawn coarser")
        ->capture_default_str();
    app.add_option("--gpu-memory", options.frame.point_memory,
                   "what the points may take on the GPU (2G, 500M); a view that needs more is "
                   "drawn coarser")
        ->transform(CLI::AsSizeValue(false));
    app.add_option("--samples", options.frame.samples,
                   "a headless pixel is the mean of this many "
                   "squared")
        ->check(CLI::Range(1, 8))
        ->capture_default_str();
    auto* exposure_option =
        app.add_option("--exposure", exposure, "stops (EV); measured from the picture without it")
            ->check(number_in(-50.0, 50.0));
    app.add_option("--tonemap", tonemap, "linear, reinhard, aces or agx")
        ->check(CLI::IsMember({"linear", "reinhard", "aces", "agx"}))
        ->capture_default_str();

    app.add_flag("--force", options.force, "overwrite an output that is there");
    app.add_flag("--json", options.json, "print the result as one JSON object on stdout");
    app.add_option("--progress", options.progress, "auto, bar, json or none")
        ->check(CLI::IsMember({"auto", "bar", "json", "none"}));
    app.add_flag("-q,--quiet", options.quiet, "say nothing but errors");
    app.add_flag("-v,--verbose", options.verbose, "say every detail");
    app.add_option("--log-file", options.log_file, "write the log to this file as well");
    app.add_option("--threads", options.threads, "how many threads to use; 0 is all")
        ->check(CLI::Range(0, 1024));

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) {
            app.exit(error);
            return std::nullopt;
        }
        fail(error.what());
    }
    check_combination(app, options);
    if (!size.empty()) options.size = size_of(size);
    if (bounces_option->count() > 0) options.bounces = bounces;
    if (exposure_option->count() > 0) options.display.exposure = exposure;
    if (light_depth_option->count() > 0) {
        options.light_depth = light_depth;
        if (light_memory_option->count() == 0) options.light_memory = 0;
    }
    options.light.memory = options.light_memory;
    if (cones_option->count() > 0 || options.light.faithful) {
        options.light.gather = Gather::kCones;
    }
    if (specular_option->count() > 0 && specular == "off" && wetness > 0.0) {
        fail("--wetness does not go with --specular off");
    }
    if (wetness_option->count() == 0 && specular == "on") wetness = 1.0;
    options.frame.wetness = static_cast<float>(wetness);
    options.light.tricubic = interpolation == "tricubic";
    if (options.headless && controls_option->count() > 0) fail("--controls is for the window");
    for (std::size_t i = 0; i < std::size(kControlNames); ++i) {
        if (controls == kControlNames[i]) options.controls = static_cast<ControlScheme>(i);
    }
    for (std::uint32_t i = 0; i < std::size(kToneCurveNames); ++i) {
        if (tonemap == kToneCurveNames[i]) options.display.curve = static_cast<ToneCurve>(i);
    }
    return options;
}

}  // namespace glowworm

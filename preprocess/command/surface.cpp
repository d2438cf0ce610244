#include "preprocess/surface/surface.h"

#include <vector>

#include "preprocess/command/command.h"
#include "preprocess/command/plan.h"
#include "preprocess/command/stage_flags.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/surface/normal_plan.h"
#include "preprocess/surface/surfel_points.h"
#include "preprocess/write/cloud_writer.h"

namespace glowworm {
namespace {

struct SurfaceFlags {
    std::filesystem::path input;
    ReadSettings read;
    SurfaceSettings settings;
    std::filesystem::path plot;
};

nlohmann::ordered_json run_surface(Run& run, const SurfaceFlags& flags) {
    const std::filesystem::path& output = run.flags.output;
    require_distinct(output, {flags.input});
    check_cloud_extension(output);
    if (!flags.plot.empty()) {
        require_writable_output(flags.plot, run.flags.force);
        require_distinct(flags.plot, {flags.input});
    }

    ConvertSettings settings;
    settings.read = flags.read;
    require_budget(run, {flags.input}, settings, Reach::kSurface);
    const PointCloud cloud =
        read_cloud(flags.input, flags.read, nullptr, run.console.phase("read", "points"));
    SurfaceReport report;
    std::vector<float> normal_errors;
    const SurfelCloud surfels = make_surfels(
        cloud, flags.settings, &report, run.console.phase("surface", "points"), &normal_errors);
    run.console.phase("write", "points");
    write_cloud(to_points(surfels), output,
                std::vector{ExtraColumn{"normal_error", normal_errors}});
    if (!flags.plot.empty()) write_png(plot_surfels(surfels), flags.plot);
    run.console.end_phase();

    say_surface(report);
    nlohmann::ordered_json result = {{"output", output.string()}};
    result.update(surface_json(report));
    return result;
}

}  // namespace

void add_surface_command(Program& program) {
    auto flags = std::make_shared<SurfaceFlags>();
    CLI::App* command = program.add(
        "surface", "a merged cloud to surfels: normals, NDF vectors, radii", true,
        [flags](Run& run) { return run_surface(run, *flags); },
        [flags](Run& run) {
            check_cloud_extension(run.flags.output);
            ConvertSettings settings;
            settings.read = flags->read;
            settings.surface = flags->settings;
            return plan_work(run, {flags->input}, settings, Reach::kSurface);
        });
    command->add_option("cloud", flags->input, "the cloud, as `glowworm merge` writes it")
        ->required();
    command->add_option("--plot", flags->plot,
                        "draw normals and NDF lengths from above into this PNG");
    add_read_flags(*command, flags->read);
    add_surface_flags(*command, flags->settings);
}

}  // namespace glowworm

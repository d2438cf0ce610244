#include "octree/build.h"

#include <spdlog/spdlog.h>

#include "octree/area_lights.h"
#include "octree/octree_file.h"
#include "preprocess/command/command.h"
#include "preprocess/command/stage_flags.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/surface/surfel_points.h"

namespace glowworm {
namespace {

struct BuildCommandFlags {
    std::filesystem::path input;
    ReadSettings read;
    BuildFlags build;
    float default_albedo = SurfaceSettings{}.default_albedo;
};

void say_defaults(const SurfelDefaults& defaults, float albedo) {
    if (defaults.colour_missing)
        spdlog::warn("the cloud has no colour: albedo {} everywhere", albedo);
    if (defaults.radius_missing)
        spdlog::info("the cloud has no radius: taken from the point spacing");
    if (defaults.ndf_missing)
        spdlog::info("the cloud has no NDF lengths: 1 everywhere, mirror-flat");
}

nlohmann::ordered_json run_build(Run& run, const BuildCommandFlags& flags) {
    const std::filesystem::path& output = run.flags.output;
    require_distinct(output, {flags.input, flags.build.lights});
    const auto lights = flags.build.area_lights();

    run.console.phase("read", "points");
    SurfelDefaults defaults;
    SurfelCloud surfels =
        to_surfels(read_cloud(flags.input, flags.read), flags.default_albedo, &defaults);
    say_defaults(defaults, flags.default_albedo);
    add_area_lights(surfels, lights);
    const BuildSettings settings = flags.build.settings("build", {flags.input});
    Octree octree = build_octree(surfels, settings, run.console.phase("build", "surfels"));
    bake_links(octree, flags.build.links, run.console.phase("links", "lobes"));

    run.console.phase("write", "bytes");
    write_octree_file(octree.view(), output);
    run.console.end_phase();
    say_octree(octree.view());
    return {{"output", output.string()},
            {"samples", octree.sample_count},
            {"dropped", octree.dropped_count},
            {"leaves", octree.levels.back().node_count},
            {"nodes", octree.nodes.size()},
            {"lobes", octree.lobes.size()},
            {"depth", octree.grid.depth},
            {"voxel_size", octree.grid.voxel_size()},
            {"area_lights", octree.area_lights.size()},
            {"bytes", std::filesystem::file_size(output)}};
}

}  // namespace

void add_build_command(Program& program) {
    auto flags = std::make_shared<BuildCommandFlags>();
    CLI::App* command = program.add("build", "surfels to the Morton-sorted octree file", true,
                                    [flags](Run& run) { return run_build(run, *flags); });
    command->add_option("surfels", flags->input, "a cloud with positions and normals")->required();
    command
        ->add_option("--default-albedo", flags->default_albedo,
                     "linear albedo of points without colour")
        ->check(finite(0.0, 1.0));
    flags->build.add_to(*command);
    add_read_flags(*command, flags->read);
}

}  // namespace glowworm

#include "octree/build.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "octree/area_lights.h"
#include "octree/build_file.h"
#include "octree/error.h"
#include "octree/links.h"
#include "octree/octree_writer.h"
#include "octree/resident_memory.h"
#include "octree/size_estimate.h"
#include "octree/spill.h"
#include "preprocess/command/command.h"
#include "preprocess/command/grid_file.h"
#include "preprocess/command/plan.h"
#include "preprocess/command/stage_flags.h"
#include "preprocess/surface/surfel_file.h"

namespace glowworm {
namespace {

struct BuildCommandFlags {
    std::filesystem::path input;
    ReadSettings read;
    BuildFlags build;
    std::filesystem::path grid;
    std::string tile;
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

/// Where the octree goes, before anything of the cloud is read.
BuildSettings grid_settings(const BuildCommandFlags& flags) {
    BuildSettings settings;
    settings.depth = flags.build.depth;
    settings.voxel_size = flags.build.voxel_size;
    if (!flags.grid.empty()) settings.grid = read_grid(flags.grid);
    if (flags.tile.empty()) return settings;
    if (!settings.grid) {
        throw Error(ExitCode::kUsage,
                    "--tile needs --grid, the grid that all tiles share; `glowworm build --dry-run "
                    "--json` prints the one of the whole cloud");
    }
    if (flags.build.links > 0) {
        throw Error(ExitCode::kUsage, "--links and --tile do not go together: light crosses tiles");
    }
    settings.tile = parse_cell(flags.tile);
    require_tile(settings);
    return settings;
}

SurfelStream open_stream(const BuildCommandFlags& flags, std::uint64_t memory_limit) {
    const SurfelFile file =
        open_surfels(flags.input, flags.read, flags.default_albedo, memory_limit);
    say_defaults(file.defaults, flags.default_albedo);
    return with_area_lights(file.stream, flags.build.area_lights());
}

/// Traces the links of the octree in `file` and writes it with them under `output`.
void write_with_links(const std::filesystem::path& file, std::uint32_t links, Run& run) {
    page_memory(run);
    const OctreeFile unlinked = OctreeFile::open(file);
    OctreeView octree = unlinked.view();
    const std::vector<std::uint32_t> traced =
        trace_links(octree, {.rays = links}, run.console.phase("links", "lobes"));
    octree.links = traced;
    octree.links_per_lobe = links;
    const Progress writing = run.console.phase("write", "bytes");
    unlinked.require_intact();
    write_octree_file(octree, run.flags.output, {.progress = writing});
}

nlohmann::ordered_json run_build(Run& run, const BuildCommandFlags& flags) {
    const std::filesystem::path& output = run.flags.output;
    require_distinct(output, {flags.input, flags.build.lights, flags.grid});
    BuildSettings settings = grid_settings(flags);

    run.console.phase("read", "points");
    const SurfelStream stream = open_stream(flags, run.flags.memory_limit);
    settings.provenance = flags.build.settings("build", {flags.input}).provenance;
    const MemorySettings memory{run.flags.memory_limit, run.flags.temp_dir};
    const Progress progress = run.console.phase("build", "surfels");
    BuildFileReport report;
    if (flags.build.links == 0) {
        report = build_octree_file(stream, settings, memory, output, progress);
    } else {
        const auto beside = output.has_parent_path() ? output.parent_path() : ".";
        const TemporaryFolder folder(run.flags.temp_dir.empty() ? beside : run.flags.temp_dir);
        const auto unlinked = folder.path() / "unlinked.svo";
        report = build_octree_file(stream, settings, memory, unlinked, progress);
        write_with_links(unlinked, flags.build.links, run);
    }
    run.console.end_phase();

    const OctreeFile file = OctreeFile::open(output);
    const OctreeView& octree = file.view();
    say_octree(octree);
    if (report.tiles > 0)
        spdlog::info("built in {} tiles to keep within {} of memory, {}; {} spilled", report.tiles,
                     format_bytes(report.memory_limit),
                     memory.limit > 0 ? "the limit" : "all that the system has left",
                     format_bytes(report.spilled_bytes));
    return {{"output", output.string()},
            {"samples", octree.sample_count},
            {"dropped", octree.dropped_count},
            {"leaves", octree.levels.back().node_count},
            {"nodes", octree.nodes.size()},
            {"lobes", octree.lobes.size()},
            {"depth", octree.grid.depth},
            {"voxel_size", octree.grid.voxel_size()},
            {"area_lights", octree.area_lights.size()},
            {"tiles", report.tiles},
            {"bytes", file.bytes()}};
}

/// One pass over the cloud: where the octree would go and what it would take.
nlohmann::ordered_json plan_build(Run& run, const BuildCommandFlags& flags) {
    const BuildSettings settings = grid_settings(flags);
    const SurfelStream stream = open_stream(flags, run.flags.memory_limit);
    CloudSummarizer summarizer;
    const Progress progress = run.console.phase("read", "points");
    std::uint64_t done = 0;
    stream.for_each([&](std::span<const Surfel> batch) {
        summarizer.add(batch);
        progress(done += batch.size(), std::max(done, stream.expected));
    });
    run.console.end_phase();
    const CloudSummary summary = summarizer.finish();
    if (summary.usable == 0) {
        throw Error(ExitCode::kDegenerate,
                    fmt::format("no point of '{}' has a finite position and a normal",
                                flags.input.string()));
    }
    const Grid grid = fit_grid(summary, stream.origin, settings);

    const auto samples = static_cast<double>(summary.usable);
    const double voxel = grid.voxel_size();
    const SizeEstimate size = estimate_size(summary, grid);
    const std::uint64_t bytes = size.disk;
    const std::uint64_t memory = memory_to_build(0) + size.memory;
    const std::uint64_t room = run.flags.memory_limit > 0 ? run.flags.memory_limit : memory_left();
    const bool spills = memory > room;
    const std::uint64_t temporary = spills ? bytes + summary.usable * sizeof(Surfel) * 5 / 4 : 0;
    const double seconds = (samples + size.leaves) * (spills ? 2e-6 : 1e-6);
    spdlog::info("depth {}, leaves of {}; {} of memory, {} on disk, about {:.0f} s", grid.depth,
                 format_length(voxel), format_bytes(std::min(memory, room)),
                 format_bytes(bytes + temporary), seconds);
    if (size.leaves > 4.0 * samples) {
        spdlog::warn(
            "about {:.0f} leaves a point: leaves are far smaller than the points' "
            "distance; a smaller --depth shows as much",
            size.leaves / samples);
    }
    require_room(summary, grid, run.flags.output);
    return {{"samples", summary.usable},
            {"dropped", summary.dropped + stream.dropped},
            {"depth", grid.depth},
            {"voxel_size", voxel},
            {"memory", std::min(memory, room)},
            {"disk", bytes},
            {"temporary_disk", temporary},
            {"seconds", seconds},
            {"grid", grid_json(grid)}};
}

}  // namespace

void add_build_command(Program& program) {
    auto flags = std::make_shared<BuildCommandFlags>();
    CLI::App* command = program.add(
        "build", "surfels to the Morton-sorted octree file", true,
        [flags](Run& run) { return run_build(run, *flags); },
        [flags](Run& run) { return plan_build(run, *flags); });
    command->add_option("surfels", flags->input, "a cloud with positions and normals")->required();
    command
        ->add_option("--default-albedo", flags->default_albedo,
                     "linear albedo of points without colour")
        ->check(finite(0.0, 1.0));
    flags->build.add_to(*command);
    command
        ->add_option("--grid", flags->grid,
                     "take root cube and depth from here: an .svo, or JSON as `build --dry-run "
                     "--json` prints it")
        ->excludes("--depth")
        ->excludes("--voxel-size");
    command->add_option("--tile", flags->tile,
                        "build only this cell of --grid: the octants x + 2y + 4z on the way from "
                        "the root, such as r073; `glowworm join` puts tiles together");
    add_read_flags(*command, flags->read);
}

}  // namespace glowworm

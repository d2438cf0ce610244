#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "octree/links.h"
#include "octree/octree_file.h"
#include "preprocess/command/command.h"
#include "preprocess/command/stage_flags.h"
#include "preprocess/pipeline.h"

namespace glowworm {
namespace {

struct ConvertFlags {
    std::vector<std::filesystem::path> inputs;
    ConvertSettings settings;
    RegistrationFlags registration;
    BuildFlags build;
};

nlohmann::ordered_json to_json(const Conversion& done, const std::filesystem::path& output,
                               const std::filesystem::path& poses) {
    const OctreeView octree = done.octree.view();
    return {{"output", output.string()},
            {"poses", poses.string()},
            {"scans", done.scans},
            {"registered", done.registration.poses.scans.size() - done.registration.unregistered},
            {"points", done.points},
            {"outliers", done.outliers},
            {"moving", done.merge.moving},
            {"surfels", octree.surfels.size()},
            {"leaves", octree.levels.back().node_count},
            {"nodes", octree.nodes.size()},
            {"lobes", octree.lobes.size()},
            {"depth", octree.grid.depth},
            {"voxel_size", octree.grid.voxel_size()},
            {"bytes", std::filesystem::file_size(output)},
            {"surface", surface_json(done.surface)},
            {"warnings", warnings_json(done.warnings)}};
}

nlohmann::ordered_json run_convert(Run& run, ConvertFlags flags) {
    const auto files = find_scan_files(flags.inputs);
    const std::filesystem::path output = run.flags.output;
    const std::filesystem::path poses = output.string() + ".poses.json";
    require_distinct(output, files);
    require_distinct(poses, files);
    require_distinct(output, {flags.build.lights, run.flags.log_file});
    require_writable_output(poses, run.flags.force);

    flags.registration.apply(flags.settings.registration);
    flags.settings.area_lights = flags.build.area_lights();
    flags.settings.build = flags.build.settings("convert", files);

    const auto begin = [&](const std::string& phase, const std::string& unit) {
        return run.console.phase(phase, unit);
    };
    Conversion done =
        convert_scans(files, flags.settings, begin, [&](const Registration& registration) {
            write_poses(registration.poses, poses);
            spdlog::info("the poses and how far to trust them are in {}", poses.string());
            if (registration.poses.scans.size() > 1) say_trust(registration);
        });
    say_warnings(done.warnings);
    say_surface(done.surface);
    say_octree(done.octree.view());

    bake_links(done.octree, flags.build.links, run.console.phase("links", "lobes"));
    run.console.phase("write", "bytes");
    write_octree_file(done.octree.view(), output);
    run.console.end_phase();
    return to_json(done, output, poses);
}

}  // namespace

void add_convert_command(Program& program) {
    auto flags = std::make_shared<ConvertFlags>();
    flags->build.links = LinkSettings{}.rays;  // what the viewer uses
    CLI::App* command =
        program.add("convert", "raw scans to an octree file, the whole pipeline in one command",
                    true, [flags](Run& run) { return run_convert(run, *flags); });
    command->add_option("scans", flags->inputs, "scan files or folders of them")->required();
    flags->registration.add_to(*command);
    flags->build.add_to(*command);
    add_read_flags(*command, flags->settings.read);
    add_surface_flags(*command, flags->settings.surface);
    command->add_flag("--allow-missing-scans", flags->settings.allow_missing_scans,
                      "go on without scans that could not be placed");
}

}  // namespace glowworm

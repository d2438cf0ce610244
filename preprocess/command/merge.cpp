#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "octree/error.h"
#include "preprocess/command/command.h"
#include "preprocess/command/plan.h"
#include "preprocess/command/stage_flags.h"
#include "preprocess/pipeline.h"
#include "preprocess/write/cloud_writer.h"

namespace glowworm {
namespace {

struct MergeFlags {
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path poses;
    ConvertSettings settings;
};

/// The settings of a conversion that starts from these poses.
ConvertSettings with_poses(ConvertSettings settings, const Poses& poses) {
    settings.registration.mode = PriorMode::kTrust;
    settings.registration.prior = poses;
    return settings;
}

nlohmann::ordered_json run_merge(Run& run, const MergeFlags& flags) {
    const auto files = find_scan_files(flags.inputs);
    const std::filesystem::path& output = run.flags.output;
    require_distinct(output, files);
    require_distinct(output, {flags.poses});
    check_cloud_extension(output);
    const Poses poses = read_poses(flags.poses);
    require_budget(run, files, with_poses(flags.settings, poses), Reach::kMerge);

    const auto begin = [&](const std::string& phase, const std::string& unit) {
        return run.console.phase(phase, unit);
    };
    Conversion done;
    const std::vector<Scan> scans = read_clean_scans(files, flags.settings, begin, done);
    say_warnings(done.warnings);
    const PointCloud cloud =
        merge_scans(scans, poses, flags.settings.merge, begin("merge", "points"), &done.merge);
    if (!done.merge.left_out.empty() && !flags.settings.allow_missing_scans) {
        throw Error(
            ExitCode::kNotTrustworthy,
            fmt::format("'{}' has no pose for {} of {} ('{}' first); "
                        "--allow-missing-scans goes on without them",
                        flags.poses.string(), done.merge.left_out.size(),
                        format_number_of(scans.size(), "scan"), done.merge.left_out.front()));
    }
    run.console.phase("write", "points");
    write_cloud(cloud, output);
    run.console.end_phase();

    spdlog::info("{} of {} points kept at a spacing of {:.1f} mm; {} were moving things",
                 format_count(cloud.points.size()), format_count(done.points),
                 done.merge.spacing * 1e3, format_count(done.merge.moving));
    return {{"output", output.string()},     {"scans", done.scans},
            {"points", cloud.points.size()}, {"read", done.points},
            {"outliers", done.outliers},     {"moving", done.merge.moving},
            {"thinned", done.merge.thinned}, {"left_out", done.merge.left_out},
            {"spacing", done.merge.spacing}, {"warnings", warnings_json(done.warnings)}};
}

}  // namespace

void add_merge_command(Program& program) {
    auto flags = std::make_shared<MergeFlags>();
    CLI::App* command = program.add(
        "merge", "scans and their poses to one cloud in the world frame", true,
        [flags](Run& run) { return run_merge(run, *flags); },
        [flags](Run& run) {
            check_cloud_extension(run.flags.output);
            return plan_work(run, find_scan_files(flags->inputs),
                             with_poses(flags->settings, read_poses(flags->poses)), Reach::kMerge);
        });
    command->add_option("scans", flags->inputs, "scan files or folders of them")->required();
    command->add_option("--poses", flags->poses, "poses.json of the scans")->required();
    command
        ->add_option("--spacing", flags->settings.merge.spacing,
                     "even spacing of the result, m; 0: the scans' own")
        ->check(finite(0.0, 1e6));
    command->add_flag("--balance-colour", flags->settings.merge.balance_colour,
                      "make the scans' colours agree where they overlap");
    command->add_flag("--allow-missing-scans", flags->settings.allow_missing_scans,
                      "go on without scans that have no pose");
    add_read_flags(*command, flags->settings.read);
}

}  // namespace glowworm

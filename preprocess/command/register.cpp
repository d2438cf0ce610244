#include <fmt/format.h>

#include "octree/error.h"
#include "preprocess/command/command.h"
#include "preprocess/command/stage_flags.h"
#include "preprocess/pipeline.h"
#include "preprocess/register/plan_view.h"

namespace glowworm {
namespace {

struct RegisterFlags {
    std::vector<std::filesystem::path> inputs;
    ConvertSettings settings;
    RegistrationFlags registration;
    std::filesystem::path plot;
};

nlohmann::ordered_json run_register(Run& run, RegisterFlags flags) {
    const auto files = find_scan_files(flags.inputs);
    require_distinct(run.flags.output, files);
    if (!flags.plot.empty()) {
        require_writable_output(flags.plot, run.flags.force);
        require_distinct(flags.plot, files);
    }
    flags.registration.apply(flags.settings.registration);

    const auto begin = [&](const std::string& phase, const std::string& unit) {
        return run.console.phase(phase, unit);
    };
    Conversion done;
    const std::vector<Scan> scans = read_clean_scans(files, flags.settings, begin, done);
    say_warnings(done.warnings);
    const Registration registration =
        align_scans(scans, flags.settings.registration, begin("register", "pairs"));
    write_poses(registration.poses, run.flags.output);
    if (!flags.plot.empty()) write_plan_view(scans, registration.poses, flags.plot);
    run.console.end_phase();

    if (!run.flags.json) fmt::print("{}", trust_table(registration));
    if (registration.unregistered > 0) {
        throw Error(
            ExitCode::kNotTrustworthy,
            fmt::format("{} of {} scans could not be placed; '{}' says how far each was trusted",
                        registration.unregistered, scans.size(), run.flags.output.string()));
    }
    return nlohmann::ordered_json::parse(format_poses(registration.poses));
}

}  // namespace

void add_register_command(Program& program) {
    auto flags = std::make_shared<RegisterFlags>();
    CLI::App* command =
        program.add("register", "raw scans to poses and a trust report per scan and per pair", true,
                    [flags](Run& run) { return run_register(run, *flags); });
    command->add_option("scans", flags->inputs, "scan files or folders of them")->required();
    command->add_option("--plot", flags->plot, "draw the placed scans from above into this PNG");
    flags->registration.add_to(*command);
    add_read_flags(*command, flags->settings.read);
}

}  // namespace glowworm

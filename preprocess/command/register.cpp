#include <fmt/format.h>

#include <functional>
#include <span>

#include "octree/error.h"
#include "preprocess/command/command.h"
#include "preprocess/command/plan.h"
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
    std::vector<std::pair<std::string, std::string>> pairs;
};

/// The scan that the user means by `name`: its path, else its file name, with or without extension.
std::size_t scan_named(std::span<const Scan> scans, const std::string& name) {
    const std::vector<std::function<std::string(const std::string&)>> readings{
        [](const std::string& file) { return file; },
        [](const std::string& file) { return std::filesystem::path(file).filename().string(); },
        [](const std::string& file) { return std::filesystem::path(file).stem().string(); }};
    for (const auto& reading : readings) {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < scans.size(); ++i) {
            if (reading(pose_file(scans[i])) == name) found.push_back(i);
        }
        if (found.size() == 1) return found[0];
        if (found.size() > 1) {
            throw Error(
                ExitCode::kUsage,
                fmt::format("--pair {}: several scans have this name; give the path", name));
        }
    }
    throw Error(
        ExitCode::kUsage,
        fmt::format("--pair {}: none of the scans has this name; give its path or file name",
                    name));
}

nlohmann::ordered_json run_register(Run& run, RegisterFlags flags) {
    const auto files = find_scan_files(flags.inputs);
    require_distinct(run.flags.output, files);
    if (!flags.plot.empty()) {
        require_writable_output(flags.plot, run.flags.force);
        require_distinct(flags.plot, files);
    }
    flags.registration.apply(flags.settings.registration);
    require_budget(run, files, flags.settings, Reach::kRegister);

    const auto begin = [&](const std::string& phase, const std::string& unit) {
        return run.console.phase(phase, unit);
    };
    Conversion done;
    const std::vector<Scan> scans = read_clean_scans(files, flags.settings, begin, done);
    say_warnings(done.warnings);
    for (const auto& [a, b] : flags.pairs) {
        flags.settings.registration.pairs.push_back({scan_named(scans, a), scan_named(scans, b)});
    }
    const Registration registration =
        align_scans(scans, flags.settings.registration, begin("register", "pairs"));
    write_poses(registration.poses, run.flags.output);
    if (!flags.plot.empty()) write_plan_view(scans, registration.poses, flags.plot);
    run.console.end_phase();

    if (!run.flags.json) fmt::print("{}", trust_table(registration));
    if (!registration.trustworthy()) {
        if (run.flags.json) fmt::print("{}\n", format_poses(registration.poses));
        throw Error(ExitCode::kNotTrustworthy,
                    fmt::format("{}; '{}' says how far each was trusted", distrust(registration),
                                run.flags.output.string()));
    }
    return nlohmann::ordered_json::parse(format_poses(registration.poses));
}

}  // namespace

void add_register_command(Program& program) {
    auto flags = std::make_shared<RegisterFlags>();
    CLI::App* command = program.add(
        "register", "raw scans to poses and a trust report per scan and per pair", true,
        [flags](Run& run) { return run_register(run, *flags); },
        [flags](Run& run) {
            ConvertSettings settings = flags->settings;
            flags->registration.apply(settings.registration);
            return plan_work(run, find_scan_files(flags->inputs), settings, Reach::kRegister);
        });
    command->add_option("scans", flags->inputs, "scan files or folders of them")->required();
    command->add_option("--plot", flags->plot, "draw the placed scans from above into this PNG");
    command->add_option("--pair", flags->pairs,
                        "two scans that overlap, by path or file name; give it again for each such "
                        "pair: then no others are tried");
    flags->registration.add_to(*command);
    add_read_flags(*command, flags->settings.read);
}

}  // namespace glowworm

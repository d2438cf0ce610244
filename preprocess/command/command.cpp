#include "preprocess/command/command.h"

#include <fmt/format.h>
#include <algorithm>

#include "octree/checksums.h"
#include "octree/error.h"
#include "octree/structure.h"
#include "preprocess/command/finished.h"
#include "preprocess/command/memory_limit.h"

namespace glowworm {

namespace {

/// `work`, and what came of it is remembered; with --resume it is not done where it is remembered.
Work unless_made(const CLI::App& command, Work work) {
    return [&command, work = std::move(work)](Run& run) -> nlohmann::ordered_json {
        const std::filesystem::path& output = run.flags.output;
        const Origin origin(command);
        if (run.flags.resume && origin.made(output)) {
            run.last_word = fmt::format("'{}' is up to date", output.string());
            return {{"output", output.string()}, {"up_to_date", true}};
        }
        if (!run.flags.force && std::filesystem::exists(output)) {
            throw Error(ExitCode::kExists,
                        fmt::format("nothing says that '{}' was made of these inputs with these "
                                    "settings; --force makes it anew",
                                    output.string()));
        }
        nlohmann::ordered_json result = work(run);
        origin.remember(output);
        return result;
    };
}

}  // namespace

CLI::App* Program::add(const std::string& name, const std::string& summary, bool needs_output,
                       Work work, Work plan, bool resumable) {
    CLI::App* command = app.add_subcommand(name, summary);
    command->fallthrough();  // --config and --version are the program's
    if (needs_output) {
        command->add_option("-o,--output", flags.output, "where the result goes")->required();
    }
    command->add_flag("--force", flags.force, "overwrite an output that is there");
    command->add_flag("--json", flags.json, "print the result as one JSON object on stdout");
    command->add_option("--progress", flags.progress, "auto, bar, json or none")
        ->check(CLI::IsMember({"auto", "bar", "json", "none"}));
    command->add_flag("-q,--quiet", flags.quiet, "say nothing but errors");
    command->add_flag("-v,--verbose", flags.verbose, "say every detail");
    command->add_option("--log-file", flags.log_file, "write the log to this file as well");
    command->add_option("--threads", flags.threads, "how many threads to use; 0 is all")
        ->check(CLI::Range(0, 1024));
    command->add_option_function<std::string>(
        "--memory-limit",
        [this](const std::string& size) { flags.memory_limit = parse_size(size); },
        "memory that may be used, such as 512M, 8G or 1.5GiB; what cannot fit is refused at once");
    command->add_option("--temp-dir", flags.temp_dir,
                        "an existing folder for temporary files; beside the output if not given");
    command->add_flag("--dry-run", flags.dry_run,
                      "predict depth, memory, disk and time, print every warning, write nothing");
    command->add_flag("--resume", flags.resume,
                      "go on from what an earlier run left; nothing to do where it is done");
    if (!plan && needs_output) {
        plan = [name](Run& run) -> nlohmann::ordered_json {
            run.last_word = fmt::format("'{}' predicts nothing; nothing was written", name);
            return {{"output", run.flags.output.string()}, {"dry_run", true}};
        };
    }
    if (needs_output && !resumable) work = unless_made(*command, std::move(work));
    command->final_callback([this, work = std::move(work), plan = std::move(plan)] {
        selected = flags.dry_run && plan ? plan : work;
    });
    return command;
}

void require_sound(const OctreeFile& file, const std::filesystem::path& path,
                   std::initializer_list<SectionKind> kinds) {
    Sentences failures = check_structure(file.view());
    if (failures.empty()) failures = check_checksums(file, kinds);
    file.require_intact();
    if (failures.empty()) return;
    throw Error(ExitCode::kCheckFailed, fmt::format("'{}' is damaged: {}; write it again",
                                                    path.string(), failures.front()));
}

std::string format_bytes(std::uint64_t bytes) {
    if (bytes < 1000) return fmt::format("{} B", bytes);
    if (bytes < 1000'000) return fmt::format("{:.1f} kB", double(bytes) * 1e-3);
    if (bytes < 1000'000'000) return fmt::format("{:.1f} MB", double(bytes) * 1e-6);
    return fmt::format("{:.2f} GB", double(bytes) * 1e-9);
}

std::string format_length(double metres) {
    if (metres < 0.01) return fmt::format("{:.3g} mm", metres * 1e3);
    if (metres < 1.0) return fmt::format("{:.3g} cm", metres * 1e2);
    return fmt::format("{:.2f} m", metres);
}

std::string format_number_of(std::uint64_t count, const std::string& one) {
    return format_count(count) + " " + one + (count == 1 ? "" : "s");
}

std::string format_count(std::uint64_t count) {
    const std::string digits = std::to_string(count);
    std::string grouped;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) grouped += ' ';
        grouped += digits[i];
    }
    return grouped;
}

}  // namespace glowworm

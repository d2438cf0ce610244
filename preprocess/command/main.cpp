#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include <exception>
#include <new>

#include "octree/error.h"
#include "preprocess/command/command.h"
#include "preprocess/command/config_file.h"
#include "preprocess/command/log_file.h"
#include "preprocess/command/memory_limit.h"
#include "preprocess/pipeline/work_folder.h"

namespace glowworm {
namespace {

/// What CLI11 only says "A subcommand is required" for.
void require_known_command(const CLI::App& app, const std::vector<std::string>& words) {
    std::string names;
    for (const CLI::App* command : app.get_subcommands({})) {
        if (!words.empty() && words[0] == command->get_name()) return;
        names += (names.empty() ? "" : ", ") + command->get_name();
    }
    if (!words.empty() && words[0].starts_with('-')) return;
    throw Error(ExitCode::kUsage,
                words.empty()
                    ? fmt::format("which command? There are {}; `glowworm --help` says more", names)
                    : fmt::format("there is no command '{}'; there are {}", words[0], names));
}

void require_folders(const SharedFlags& flags) {
    std::error_code ignored;
    if (!flags.temp_dir.empty() && (!std::filesystem::is_directory(flags.temp_dir, ignored) ||
                                    ::access(flags.temp_dir.c_str(), W_OK) != 0)) {
        throw Error(ExitCode::kUnreadable,
                    fmt::format("--temp-dir '{}' is no folder that may be written; make it first",
                                flags.temp_dir.string()));
    }
}

int run(int argc, char** argv) {
    CLI::App app{"Turns raw LiDAR scans of caves into lit, walkable octrees.", "glowworm"};
    app.set_version_flag("--version", "glowworm " GLOWWORM_VERSION);
    app.set_config("--config", "", "read flags from this TOML file; the command line wins");
    app.config_formatter(config_file(app));
    app.require_subcommand(1);

    SharedFlags flags;
    Work selected;
    Program program{app, flags, selected};
    add_convert_command(program);
    add_ingest_command(program);
    add_job_commands(program);
    add_register_command(program);
    add_merge_command(program);
    add_surface_command(program);
    add_build_command(program);
    add_info_command(program);
    add_check_command(program);
    add_diff_command(program);
    add_extract_command(program);
    add_join_command(program);

    require_known_command(app, {argv + 1, argv + argc});
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        const bool asked_for_text = error.get_exit_code() == 0;
        if (asked_for_text) return app.exit(error);
        const auto given = app.get_subcommands();
        throw Error(ExitCode::kUsage,
                    fmt::format("{}; `glowworm {}--help` shows what there is", error.what(),
                                given.empty() ? "" : given.front()->get_name() + " "));
    }

    if (!flags.output.empty()) {
        const bool may_exist = flags.force || flags.resume;
        require_writable_output(flags.output, may_exist);
        if (!flags.dry_run) remove_abandoned(flags.output);
    }
    require_folders(flags);
    set_up_log(flags, *app.get_subcommands().front());
    const char* cancelled = flags.progress == "json"
                                ? "{\"log\":\"error\",\"sentence\":\"cancelled\"}\n"
                                : "glowworm: cancelled\n";
    install_signal_handlers(flags.output.empty() || flags.dry_run ? cancelled : nullptr);
    const int threads = flags.threads > 0 ? flags.threads : tbb::info::default_concurrency();
    // Never let go: that would start threads, for which there may be no memory.
    static const auto* const at_most = new tbb::global_control(
        tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    static_cast<void>(at_most);
    limit_memory(flags.memory_limit, threads);

    Console console(
        progress_mode(flags.quiet && flags.progress == "auto" ? "none" : flags.progress));
    Run context{flags, console, {argv, argv + argc}, {}, {}};
    const nlohmann::ordered_json result = selected(context);
    console.end_phase();
    if (flags.json) fmt::print("{}\n", result.dump(2));
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        throw Error(ExitCode::kBudget, "cannot write the result to standard output");
    }
    if (!context.last_word.empty()) {
        spdlog::info("{}", context.last_word);
    } else if (!flags.output.empty() && !flags.dry_run) {
        spdlog::info("wrote {}", flags.output.string());
    }
    return static_cast<int>(ExitCode::kDone);
}

/// Whether stderr is to hold one JSON object a line; asked before and whether or not flags parse.
bool speaks_json(std::span<char*> words) {
    for (std::size_t i = 1; i < words.size(); ++i) {
        const std::string_view word = words[i], before = words[i - 1];
        if (word == "--progress=json" || (before == "--progress" && word == "json")) return true;
    }
    return false;
}

int say(std::span<char*> words, ExitCode code, const std::string& sentence) {
    if (speaks_json(words)) {
        const nlohmann::ordered_json line = {{"log", "error"}, {"sentence", sentence}};
        fmt::print(stderr, "{}\n",
                   line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    } else {
        fmt::print(stderr, "glowworm: {}\n", sentence);
    }
    return static_cast<int>(code);
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    using glowworm::ExitCode;
    const std::span words(argv, static_cast<std::size_t>(argc));
    try {
        return glowworm::run(argc, argv);
    } catch (const glowworm::Error& error) {
        return glowworm::say(words, error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return glowworm::say(words, ExitCode::kBudget,
                             "out of memory; give more with --memory-limit, or use fewer scans");
    } catch (const std::exception& error) {
        // What TBB throws where no memory is left for a thread's stack.
        if (std::string_view(error.what()).starts_with("pthread_create")) {
            return glowworm::say(words, ExitCode::kBudget,
                                 "no memory for another thread; give more with --memory-limit, or "
                                 "use fewer --threads");
        }
        return glowworm::say(words, ExitCode::kInternal,
                             fmt::format("internal error: {}", error.what()));
    }
}

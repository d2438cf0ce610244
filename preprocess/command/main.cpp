#include <fmt/format.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <exception>
#include <new>

#include "octree/error.h"
#include "preprocess/command/command.h"

namespace glowworm {
namespace {

void set_up_logging(const SharedFlags& flags) {
    std::vector<spdlog::sink_ptr> sinks{std::make_shared<spdlog::sinks::stderr_color_sink_st>()};
    if (!flags.log_file.empty()) {
        try {
            sinks.push_back(
                std::make_shared<spdlog::sinks::basic_file_sink_st>(flags.log_file.string()));
        } catch (const spdlog::spdlog_ex&) {
            throw Error(ExitCode::kUnreadable,
                        "cannot write the log file '" + flags.log_file.string() + "'");
        }
    }
    auto logger = std::make_shared<spdlog::logger>("glowworm", sinks.begin(), sinks.end());
    logger->set_pattern("%^%l%$: %v");
    logger->set_level(flags.quiet     ? spdlog::level::err
                      : flags.verbose ? spdlog::level::debug
                                      : spdlog::level::info);
    spdlog::set_default_logger(std::move(logger));
}

int run(int argc, char** argv) {
    CLI::App app{"Turns raw LiDAR scans of caves into lit, walkable octrees.", "glowworm"};
    app.set_version_flag("--version", "glowworm " GLOWWORM_VERSION);
    app.set_config("--config", "", "read flags from this TOML file; the command line wins");
    app.require_subcommand(1);

    SharedFlags flags;
    Work selected;
    Program program{app, flags, selected};
    add_convert_command(program);
    add_register_command(program);
    add_merge_command(program);
    add_surface_command(program);
    add_build_command(program);
    add_info_command(program);
    add_check_command(program);
    add_diff_command(program);
    add_extract_command(program);

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        const bool asked_for_text = error.get_exit_code() == 0;
        if (asked_for_text) return app.exit(error);
        throw Error(ExitCode::kUsage,
                    fmt::format("{}; `glowworm --help` shows what there is", error.what()));
    }

    set_up_logging(flags);
    install_cancel_handlers();
    const tbb::global_control threads(
        tbb::global_control::max_allowed_parallelism,
        static_cast<std::size_t>(flags.threads > 0 ? flags.threads
                                                   : tbb::info::default_concurrency()));
    if (!flags.output.empty()) require_writable_output(flags.output, flags.force);

    Console console(
        progress_mode(flags.quiet && flags.progress == "auto" ? "none" : flags.progress));
    Run context{flags, console, {argv, argv + argc}};
    const nlohmann::ordered_json result = selected(context);
    console.end_phase();
    if (flags.json) fmt::print("{}\n", result.dump(2));
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        throw Error(ExitCode::kBudget, "cannot write the result to standard output");
    }
    if (!flags.output.empty()) spdlog::info("wrote {}", flags.output.string());
    return static_cast<int>(ExitCode::kDone);
}

int say(ExitCode code, const std::string& sentence) {
    fmt::print(stderr, "glowworm: {}\n", sentence);
    return static_cast<int>(code);
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    using glowworm::ExitCode;
    try {
        return glowworm::run(argc, argv);
    } catch (const glowworm::Error& error) {
        return glowworm::say(error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return glowworm::say(ExitCode::kBudget, "out of memory; use fewer scans or larger voxels");
    } catch (const std::exception& error) {
        return glowworm::say(ExitCode::kInternal, fmt::format("internal error: {}", error.what()));
    }
}

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <exception>
#include <new>
#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "viewer/app/headless.h"
#include "viewer/app/window.h"

namespace glowworm {
namespace {

int run(int argc, char** argv) {
    const std::optional<Options> options = read_options(argc, argv);
    if (!options) return static_cast<int>(ExitCode::kDone);
    set_up_logging(options->quiet, options->verbose, options->log_file);
    install_cancel_handlers();
    const tbb::global_control threads(
        tbb::global_control::max_allowed_parallelism,
        static_cast<std::size_t>(options->threads > 0 ? options->threads
                                                      : tbb::info::default_concurrency()));

    const Cave cave = open_cave(options->octree, options->light_depth);
    if (!options->headless) {
        run_window(*options, cave);
        return static_cast<int>(ExitCode::kDone);
    }
    Console console(Console::mode_of(
        options->quiet && options->progress == "auto" ? "none" : options->progress));
    const nlohmann::ordered_json result = run_headless(*options, cave, console);
    console.end_phase();
    if (options->json) fmt::print("{}\n", result.dump(2));
    spdlog::info("wrote {}", (options->stats.empty() ? options->output : options->stats).string());
    return static_cast<int>(ExitCode::kDone);
}

int say(ExitCode code, const std::string& sentence) {
    fmt::print(stderr, "glowworm-view: {}\n", sentence);
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
        return glowworm::say(ExitCode::kBudget,
                             "out of memory; ask for a smaller picture or octree");
    } catch (const std::exception& error) {
        return glowworm::say(ExitCode::kInternal, fmt::format("internal error: {}", error.what()));
    }
}

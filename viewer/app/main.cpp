#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "octree/checksums.h"
#include "octree/error.h"
#include "viewer/app/console.h"
#include "viewer/app/headless.h"
#include "viewer/app/window.h"

namespace glowworm {
namespace {

int run(int argc, char** argv) {
    const std::optional<Options> options = read_options(argc, argv);
    if (!options) return static_cast<int>(ExitCode::kDone);
    const Console::Mode mode = Console::mode_of(
        options->quiet && options->progress == "auto" ? "none" : options->progress);
    set_up_logging(mode, options->quiet, options->verbose, options->log_file);
    install_cancel_handlers();
    const tbb::global_control threads(
        tbb::global_control::max_allowed_parallelism,
        static_cast<std::size_t>(options->threads > 0 ? options->threads
                                                      : tbb::info::default_concurrency()));

    const Cave cave =
        open_cave(options->octree, {options->light_depth, options->light_memory, options->light});
    if (!options->headless) {
        run_window(*options, cave);
        return static_cast<int>(ExitCode::kDone);
    }
    // All of it is about to be read: comparing checksums costs some GB a second more.
    warn_of_damage(options->octree, check_checksums(cave.file));
    cave.file.require_intact();
    Console console(mode);
    const nlohmann::ordered_json result = run_headless(*options, cave, console);
    console.end_phase();
    if (options->json) fmt::print("{}\n", result.dump(2));
    spdlog::info("wrote {}", (options->stats.empty() ? options->output : options->stats).string());
    return static_cast<int>(ExitCode::kDone);
}

/// Whether stderr is to hold one JSON object a line; asked whether or not the flags parse.
bool speaks_json(std::span<char*> words) {
    for (std::size_t i = 1; i < words.size(); ++i) {
        const std::string_view word = words[i], before = words[i - 1];
        if (word == "--progress=json" || (before == "--progress" && word == "json")) return true;
    }
    return false;
}

int say(std::span<char*> words, ExitCode code, const std::string& sentence) {
    if (speaks_json(words)) {
        fmt::print(stderr, "{{\"log\":\"error\",\"sentence\":{}}}\n", json_text(sentence));
    } else {
        fmt::print(stderr, "glowworm-view: {}\n", sentence);
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
                             "out of memory; ask for a smaller picture or octree");
    } catch (const std::exception& error) {
        return glowworm::say(words, ExitCode::kInternal,
                             fmt::format("internal error: {}", error.what()));
    }
}

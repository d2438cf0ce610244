#include "preprocess/command/log_file.h"

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "preprocess/command/command.h"
#include "preprocess/command/octree_info.h"
#include "preprocess/read/registry.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;

/// A message as a JSON string.
class JsonText : public spdlog::custom_flag_formatter {
  public:
    void format(const spdlog::details::log_msg& message, const std::tm&,
                spdlog::memory_buf_t& out) override {
        const std::string text =
            nlohmann::json(std::string(message.payload.data(), message.payload.size()))
                .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
        out.append(text.data(), text.data() + text.size());
    }
    std::unique_ptr<custom_flag_formatter> clone() const override {
        return std::make_unique<JsonText>();
    }
};

void require_log_file(const fs::path& path, const CLI::App& command) {
    std::error_code ignored;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored)) {
        throw Error(ExitCode::kUnreadable,
                    fmt::format("the log file's folder '{}' does not exist; make it first",
                                folder.string()));
    }
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("the log file '{}' is no regular file; name a file", path.string()));
    }
    for (const CLI::Option* option : command.get_options()) {
        if (option->check_lname("log-file")) continue;
        for (const std::string& word : option->results()) {
            const bool same = fs::exists(path, ignored) ? fs::equivalent(path, word, ignored)
                                                        : fs::weakly_canonical(path, ignored) ==
                                                              fs::weakly_canonical(word, ignored);
            if (!same) continue;
            throw Error(ExitCode::kUsage,
                        fmt::format("the log file '{}' is an input or the output as well; choose "
                                    "another name for it",
                                    path.string()));
        }
    }
    if (!fs::exists(path, ignored) || fs::file_size(path, ignored) == 0) return;
    if (recognise_format(path) != nullptr || is_octree_file(path)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("the log file '{}' holds a scan or an octree; choose another name "
                                "for it",
                                path.string()));
    }
}

}  // namespace

void set_up_log(const SharedFlags& flags, const CLI::App& command) {
    std::vector<spdlog::sink_ptr> sinks{std::make_shared<spdlog::sinks::stderr_color_sink_st>()};
    if (!flags.log_file.empty()) {
        require_log_file(flags.log_file, command);
        try {
            sinks.push_back(
                std::make_shared<spdlog::sinks::basic_file_sink_st>(flags.log_file.string()));
        } catch (const spdlog::spdlog_ex&) {
            throw Error(ExitCode::kUnreadable,
                        fmt::format("cannot write the log file '{}'; choose another place for it",
                                    flags.log_file.string()));
        }
    }
    auto logger = std::make_shared<spdlog::logger>("glowworm", sinks.begin(), sinks.end());
    logger->set_pattern("%^%l%$: %v");
    if (flags.progress == "json") {
        auto lines = std::make_unique<spdlog::pattern_formatter>();
        lines->add_flag<JsonText>('*').set_pattern(R"({"log":"%l","sentence":%*})");
        sinks.front()->set_formatter(std::move(lines));
    }
    logger->set_level(flags.quiet     ? spdlog::level::err
                      : flags.verbose ? spdlog::level::debug
                                      : spdlog::level::info);
    logger->set_error_handler([](const std::string&) {});
    spdlog::set_default_logger(std::move(logger));
}

}  // namespace glowworm

#include "viewer/app/console.h"

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "octree/error.h"

namespace glowworm {
namespace {

volatile std::sig_atomic_t cancel_asked = 0;

constexpr auto kShortestInterval = std::chrono::milliseconds(100);
constexpr int kBarWidth = 24;

/// "12 s", "3 min 05 s", "2 h 07 min".
std::string duration_text(double seconds) {
    const auto s = static_cast<long>(seconds + 0.5);
    if (s < 60) return fmt::format("{} s", s);
    if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
    return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

/// A message as a JSON string.
class JsonText : public spdlog::custom_flag_formatter {
  public:
    void format(const spdlog::details::log_msg& message, const std::tm&,
                spdlog::memory_buf_t& out) override {
        const std::string text = json_text({message.payload.data(), message.payload.size()});
        out.append(text.data(), text.data() + text.size());
    }
    std::unique_ptr<custom_flag_formatter> clone() const override {
        return std::make_unique<JsonText>();
    }
};

}  // namespace

std::string json_text(std::string_view text) {
    return nlohmann::json(std::string(text))
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void install_cancel_handlers() {
    struct sigaction action = {};
    action.sa_handler = [](int) { cancel_asked = 1; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigaction(SIGINT, &action, nullptr);
    ::sigaction(SIGTERM, &action, nullptr);
}

bool cancel_requested() {
    return cancel_asked != 0;
}

Console::Mode Console::mode_of(const std::string& name) {
    if (name == "bar") return Mode::kBar;
    if (name == "json") return Mode::kJson;
    if (name == "none") return Mode::kNone;
    return ::isatty(STDERR_FILENO) != 0 ? Mode::kBar : Mode::kNone;
}

Console::~Console() {
    if (!phase_.empty() && mode_ == Mode::kBar) fmt::print(stderr, "\n");
}

Progress Console::phase(const std::string& name, const std::string& unit) {
    end_phase();
    phase_ = name;
    unit_ = unit;
    total_ = 0;
    started_ = std::chrono::steady_clock::now();
    show(0, 0, false);
    return [this](std::uint64_t done, std::uint64_t total) {
        if (cancel_requested()) {
            throw Error(ExitCode::kCancelled, "cancelled; nothing was written");
        }
        total_ = total;
        if (std::chrono::steady_clock::now() - last_shown_ >= kShortestInterval) {
            show(done, total, false);
        }
    };
}

void Console::end_phase() {
    if (phase_.empty()) return;
    show(total_, total_, true);
    phase_.clear();
}

void Console::show(std::uint64_t done, std::uint64_t total, bool ended) {
    last_shown_ = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(last_shown_ - started_).count();
    if (!ended && total > 0) done = std::min(done, total - 1);

    if (mode_ == Mode::kJson) {
        // Phases and units are our own plain words: nothing to escape.
        fmt::print(stderr,
                   R"({{"phase":"{}","done":{},"total":{},"unit":"{}","seconds":{:.3f}}})"
                   "\n",
                   phase_, done, total, unit_, seconds);
    } else if (mode_ == Mode::kBar) {
        const double part = ended ? 1.0 : total > 0 ? double(done) / double(total) : 0.0;
        const int filled = static_cast<int>(part * kBarWidth);
        fmt::print(stderr, "\r\033[K{:<12} [{:<{}}] {:3.0f} % {:6.1f} s", phase_,
                   std::string(static_cast<std::size_t>(filled), '='), kBarWidth, part * 100.0,
                   seconds);
        if (total > 0) fmt::print(stderr, "  {} {}", ended ? total : done, unit_);
        if (!ended && total > 0 && done > 0) {
            const double left = seconds * static_cast<double>(total - done) / double(done);
            fmt::print(stderr, ", {} left", duration_text(left));
        }
        if (ended) fmt::print(stderr, "\n");
    }
    std::fflush(stderr);
}

void set_up_logging(Console::Mode mode, bool quiet, bool verbose,
                    const std::filesystem::path& file) {
    std::vector<spdlog::sink_ptr> sinks{std::make_shared<spdlog::sinks::stderr_color_sink_st>()};
    if (!file.empty()) {
        try {
            sinks.push_back(std::make_shared<spdlog::sinks::basic_file_sink_st>(file.string()));
        } catch (const spdlog::spdlog_ex&) {
            throw Error(ExitCode::kUnreadable,
                        fmt::format("cannot write the log file '{}'", file.string()));
        }
    }
    auto logger = std::make_shared<spdlog::logger>("glowworm-view", sinks.begin(), sinks.end());
    logger->set_pattern("%^%l%$: %v");
    if (mode == Console::Mode::kJson) {
        auto lines = std::make_unique<spdlog::pattern_formatter>();
        lines->add_flag<JsonText>('*').set_pattern(R"({"log":"%l","sentence":%*})");
        sinks.front()->set_formatter(std::move(lines));
    }
    logger->set_level(quiet     ? spdlog::level::err
                      : verbose ? spdlog::level::debug
                                : spdlog::level::info);
    spdlog::set_default_logger(std::move(logger));
}

}  // namespace glowworm

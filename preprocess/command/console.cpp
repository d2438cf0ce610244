#include "preprocess/command/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "octree/error.h"

namespace glowworm {
namespace {

volatile std::sig_atomic_t cancel_requested = 0;
const char* said_at_the_end = nullptr;

constexpr auto kShortestInterval = std::chrono::milliseconds(100);
constexpr int kBarWidth = 24;

}  // namespace

void install_signal_handlers(const char* last_words) {
    said_at_the_end = last_words;
    struct sigaction action = {};
    action.sa_handler = [](int) {
        cancel_requested = 1;
        if (said_at_the_end == nullptr) return;
        [[maybe_unused]] const ssize_t said =
            ::write(STDERR_FILENO, said_at_the_end, std::strlen(said_at_the_end));
        ::_exit(static_cast<int>(ExitCode::kCancelled));
    };
    // A second signal ends the program at once, for work that takes long to listen.
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigaction(SIGINT, &action, nullptr);
    ::sigaction(SIGTERM, &action, nullptr);
    // A file beyond the user's limit is an error of the write, which has a sentence.
    std::signal(SIGXFSZ, SIG_IGN);
}

void throw_if_cancelled() {
    if (cancel_requested != 0)
        throw Error(ExitCode::kCancelled, "cancelled before the output was written");
}

ProgressMode progress_mode(const std::string& name) {
    if (name == "bar") return ProgressMode::kBar;
    if (name == "json") return ProgressMode::kJson;
    if (name == "none") return ProgressMode::kNone;
    return ::isatty(STDERR_FILENO) != 0 ? ProgressMode::kBar : ProgressMode::kNone;
}

Console::~Console() {
    if (!phase_.empty() && mode_ == ProgressMode::kBar) fmt::print(stderr, "\n");
}

Progress Console::phase(const std::string& name, const std::string& unit) {
    end_phase();
    phase_ = name;
    unit_ = unit;
    total_ = 0;
    started_ = std::chrono::steady_clock::now();
    last_shown_ = {};
    show(0, 0, false);
    return [this](std::uint64_t done, std::uint64_t total) {
        throw_if_cancelled();
        const std::lock_guard lock(mutex_);
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
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - started_).count();
    last_shown_ = now;
    if (!ended && total > 0) done = std::min(done, total - 1);

    if (mode_ == ProgressMode::kJson) {
        const nlohmann::ordered_json line = {{"phase", phase_},
                                             {"done", done},
                                             {"total", total},
                                             {"unit", unit_},
                                             {"seconds", seconds}};
        fmt::print(stderr, "{}\n", line.dump());
    } else if (mode_ == ProgressMode::kBar) {
        const double part = ended ? 1.0 : total > 0 ? double(done) / double(total) : 0.0;
        const int filled = static_cast<int>(part * kBarWidth);
        fmt::print(stderr, "\r\033[K{:<12} [{:<{}}] {:3.0f} % {:6.1f} s", phase_,
                   std::string(static_cast<std::size_t>(filled), '='), kBarWidth,
                   std::min(100.0, part * 100.0), seconds);
        if (total > 0) fmt::print(stderr, "  {} {}", ended ? total : done, unit_);
        if (ended) fmt::print(stderr, "\n");
    }
    std::fflush(stderr);
}

}  // namespace glowworm

#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "octree/progress.h"

namespace glowworm {

enum class ProgressMode { kBar, kJson, kNone };

/// "auto" is a bar where stderr is a terminal and nothing elsewhere.
ProgressMode progress_mode(const std::string& name);

/// What a person or a workflow engine sees while work runs: one phase after the other, on stderr.
class Console {
  public:
    explicit Console(ProgressMode mode) : mode_(mode) {}
    /// A phase that an error cut short is never shown as done.
    ~Console();

    /// Begins a phase and ends the one before it. The function returned reports its progress; it
    /// throws Error (kCancelled) once the user has asked to stop. A phase shows 100 % only when it
    /// is ended, so the last one does when its output is in place.
    Progress phase(const std::string& name, const std::string& unit);

    /// Ends the phase that runs: now it is done.
    void end_phase();

  private:
    void show(std::uint64_t done, std::uint64_t total, bool ended);

    ProgressMode mode_;
    std::mutex mutex_;
    std::string phase_, unit_;
    std::uint64_t total_ = 0;
    std::chrono::steady_clock::time_point started_, last_shown_;
};

/// SIGINT and SIGTERM ask to stop: the next progress report throws; or, for a command that writes
/// nothing, they end the program at once with kCancelled and `last_words`, which live as long as
/// the program. A file that grows beyond the user's limit (SIGXFSZ) becomes a failed write.
void install_signal_handlers(const char* last_words = nullptr);

/// Throws Error (kCancelled) once the user has asked to stop.
void throw_if_cancelled();

}  // namespace glowworm

#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

#include "octree/progress.h"

namespace glowworm {

/// What the viewer says while it works: phases on stderr, as a bar on a terminal or as one JSON
/// object a line.
class Console {
  public:
    enum class Mode { kBar, kJson, kNone };

    /// `name` is auto, bar, json or none; auto is a bar where stderr is a terminal.
    static Mode mode_of(const std::string& name);

    explicit Console(Mode mode) : mode_(mode) {}
    ~Console();

    /// Begins a phase and ends the one before it. The progress it returns throws Error (kCancelled)
    /// once the user has asked to stop.
    Progress phase(const std::string& name, const std::string& unit);
    /// Ends the phase that runs; only now it shows 100 %.
    void end_phase();

  private:
    void show(std::uint64_t done, std::uint64_t total, bool ended);

    Mode mode_;
    std::string phase_, unit_;
    std::uint64_t total_ = 0;
    std::chrono::steady_clock::time_point started_, last_shown_;
};

/// After this SIGINT and SIGTERM ask to stop: the next progress report throws, a window closes. A
/// second one ends the program.
void install_cancel_handlers();
/// Whether they have asked.
bool cancel_requested();

/// Logs to stderr and, where it is not empty, to `file`. In the mode kJson what goes to stderr are
/// objects {"log":LEVEL,"sentence":TEXT}, a line each like the progress between them. Throws Error
/// (kUnreadable) where the file cannot be written.
void set_up_logging(Console::Mode mode, bool quiet, bool verbose,
                    const std::filesystem::path& file);

/// Text as a JSON string, its quotes included; what is not UTF-8 is replaced.
std::string json_text(std::string_view text);

}  // namespace glowworm

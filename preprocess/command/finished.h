#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace glowworm {

/// What a command makes its output of: its flags and the files they name. Those that say how to
/// work and not what comes of it (--threads, --json, …) do not count.
class Origin {
  public:
    /// Of a command whose flags are parsed. Throws as find_scan_files for its folders.
    explicit Origin(const CLI::App& command);

    /// Whether `output`, and every picture asked for beside it, is there and was made of this.
    /// Files are told by their times, else by their content.
    bool made(const std::filesystem::path& output) const;

    /// Keeps with `output`, which is just made, what it was made of; not where a file changed
    /// since.
    void remember(const std::filesystem::path& output) const;

  private:
    std::string content() const;

    std::string words_;                               // command, version, flags
    std::vector<std::filesystem::path> files_;        // read
    std::vector<std::filesystem::path> side_output_;  // written beside the output
    std::string state_, content_;  // of the files before the work; one of the two
};

}  // namespace glowworm
